//! Contact of one wheel on one rail, solved off-line into tables over lateral shift.
//!
//! For a wheel shifted outward by `u` the vertical gap at the wheel coordinate `w` is
//! `g(w; u) = down_rail(w + u) - down_wheel(w)`. A rigid wheel would sink until the smallest gap is
//! gone, and its contact would jump. An elastic patch spreads over every place where the gap is
//! within a few micrometres of the smallest, so the contact is taken as a **soft minimum**:
//!
//! `touch(u) = -eps ln( integral exp(-g / eps) dw )`, `eps = 5 micrometres`
//!
//! and everything else is a mean with the weights `exp(-g / eps)`: position, radius, curvature, and
//! the slope `-d touch / du`, which is exactly the weighted mean of the rail's slope. One potential
//! gives all columns, so they are continuous in `u` and the normal force does no net work around a
//! closed path. `eps` stands against an elastic approach of about 90 micrometres at 100 kN: it
//! smooths jumps narrower than the patch and leaves the radii of the profiles alone.
//!
//! Two **zones**, tread and flange, divide the wheel in the throat. Next to the divide each zone is
//! ground back by a parabola, so that a contact never sits on an artificial edge and the load
//! passes from one zone to the other through a range of shift where both carry.
//!
//! Roll of the wheel by `phi`, outward side down, turns the rail's centre of curvature about the
//! tape circle, so it is to first order a shift and a lift. With `rail_radius` the depth of that
//! centre below the tape circle: slope, position, radius and curvature are those at the shift
//! `u - phi * rail_radius`, the tangent in track axes is that slope less `phi`, and the touch is
//! that at the same shift less `phi * (lateral + (rail_radius - radius_deviation) * slope)`.
//!
//! Limits: one wheel at a time, no yaw (the longitudinal offset of the contact of a yawed wheel is
//! left out), rigid rail cant, profiles single-valued from above.

mod pair;
mod placement;
mod soft_minimum;

pub use pair::{Both, ContactPair};
pub use placement::{PlacedRail, Placement};

#[cfg(test)]
mod tests;
