"use strict";
// First of all scripts, so that it hears of everything that goes wrong after it.
(() => {
  const page = document.documentElement;
  page.complain = (what) => {
    page.dataset.pageErrors = [page.dataset.pageErrors, what].filter(Boolean).join(" | ");
  };
  addEventListener("error", (event) => page.complain(event.message));
  document.addEventListener("securitypolicyviolation", (event) =>
    page.complain(`${event.violatedDirective} refused ${event.blockedURI}`));
})();
