//! Effects at a size that a record of a second shows, for dampers of any size.

use firmware_core::damper::effects::CATALOGUE;
use firmware_core::damper::{Effect, Nominal};

/// The whole catalogue in its order, `size` times what is seen in service.
pub(crate) fn catalogue_at(nominal: &Nominal, size: f64) -> Vec<Effect> {
    CATALOGUE.iter().map(|info| effect_at(info.name, nominal, size)).collect()
}

/// The effects of these names in their order.
pub(crate) fn effects_at<const N: usize>(
    names: [&str; N],
    nominal: &Nominal,
    size: f64,
) -> [Effect; N] {
    names.map(|name| effect_at(name, nominal, size))
}

fn effect_at(name: &str, nominal: &Nominal, size: f64) -> Effect {
    Effect::in_service(name, nominal, size).unwrap_or_else(|error| panic!("{name}: {error}"))
}
