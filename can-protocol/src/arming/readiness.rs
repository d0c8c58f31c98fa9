//! Readiness: what a rig knows of itself before it may move, and what a side requires of it.
use super::item::ArmItem;
use super::refusal::Shortfall;

/// What the rig answers. Values that it does not know travel as all ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Readiness {
    /// The boot number of its heartbeat: the rig is alive.
    pub boot: u32,
    /// The key switch of the rig enables motion.
    pub enabled: bool,
    /// Age of the load cell's zero, taken with the damper unpinned, s; `None` when there is none.
    pub zero_age_s: Option<u32>,
    /// The shunt check of the load cell passed.
    pub shunt_passed: bool,
    /// Magnitude of the force at rest, N. It is judged, never tared away.
    pub force_at_rest_n: Option<u32>,
    /// Stroke left in extension, the nearer of ram and damper, µm.
    pub stroke_out_um: u32,
    /// Stroke left in compression, likewise, µm.
    pub stroke_in_um: u32,
}

/// What host or rig requires of a rig that is to be armed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Requirements {
    /// Whether the key switch must enable motion: always on a real bus.
    pub enabled: bool,
    /// The oldest zero of the load cell, s.
    pub zero_age_s: u32,
    /// Whether the shunt check must have passed.
    pub shunt_passed: bool,
    /// The largest force at rest, N.
    pub force_at_rest_n: u32,
    /// The least stroke left to either end, µm.
    pub stroke_um: u32,
}

impl Readiness {
    /// The items of readiness, in the order in which they are asked.
    pub const ITEMS: [ArmItem; 7] = [
        ArmItem::Alive,
        ArmItem::Enabled,
        ArmItem::ZeroAge,
        ArmItem::ShuntCheck,
        ArmItem::ForceAtRest,
        ArmItem::StrokeOut,
        ArmItem::StrokeIn,
    ];

    /// The value of an item, `None` when the item is none of readiness.
    pub fn get(&self, item: ArmItem) -> Option<u32> {
        match item {
            ArmItem::Alive => Some(self.boot),
            ArmItem::Enabled => Some(u32::from(self.enabled)),
            ArmItem::ZeroAge => Some(self.zero_age_s.unwrap_or(u32::MAX)),
            ArmItem::ShuntCheck => Some(u32::from(self.shunt_passed)),
            ArmItem::ForceAtRest => Some(self.force_at_rest_n.unwrap_or(u32::MAX)),
            ArmItem::StrokeOut => Some(self.stroke_out_um),
            ArmItem::StrokeIn => Some(self.stroke_in_um),
            _ => None,
        }
    }

    /// The first item that falls short of what is required.
    pub fn shortfall(&self, required: &Requirements) -> Option<Shortfall> {
        Self::ITEMS.into_iter().find_map(|item| required.shortfall(item, self.get(item)?))
    }
}

impl Requirements {
    /// Whether the value of one item falls short. A zero or a force at rest that is not known
    /// always does.
    pub fn shortfall(&self, item: ArmItem, found: u32) -> Option<Shortfall> {
        let at_most = |needed| (found > needed || found == u32::MAX, needed);
        let at_least = |needed| (found < needed, needed);
        let (falls_short, needed) = match item {
            ArmItem::Enabled => at_least(u32::from(self.enabled)),
            ArmItem::ZeroAge => at_most(self.zero_age_s),
            ArmItem::ShuntCheck => at_least(u32::from(self.shunt_passed)),
            ArmItem::ForceAtRest => at_most(self.force_at_rest_n),
            ArmItem::StrokeOut | ArmItem::StrokeIn => at_least(self.stroke_um),
            _ => (false, 0),
        };
        falls_short.then_some(Shortfall { item, found, needed })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const READY: Readiness = Readiness {
        boot: 7,
        enabled: true,
        zero_age_s: Some(600),
        shunt_passed: true,
        force_at_rest_n: Some(50),
        stroke_out_um: 20_000,
        stroke_in_um: 20_000,
    };
    const REQUIRED: Requirements = Requirements {
        enabled: true,
        zero_age_s: 600,
        shunt_passed: true,
        force_at_rest_n: 50,
        stroke_um: 20_000,
    };

    #[test]
    fn each_item_is_named_when_it_falls_short() {
        assert_eq!(READY.shortfall(&REQUIRED), None);
        for (readiness, item) in [
            (Readiness { enabled: false, ..READY }, ArmItem::Enabled),
            (Readiness { zero_age_s: Some(601), ..READY }, ArmItem::ZeroAge),
            (Readiness { zero_age_s: None, ..READY }, ArmItem::ZeroAge),
            (Readiness { shunt_passed: false, ..READY }, ArmItem::ShuntCheck),
            (Readiness { force_at_rest_n: Some(51), ..READY }, ArmItem::ForceAtRest),
            (Readiness { force_at_rest_n: None, ..READY }, ArmItem::ForceAtRest),
            (Readiness { stroke_out_um: 19_999, ..READY }, ArmItem::StrokeOut),
            (Readiness { stroke_in_um: 0, ..READY }, ArmItem::StrokeIn),
        ] {
            let shortfall = readiness.shortfall(&REQUIRED).map(|shortfall| shortfall.item);
            assert_eq!(shortfall, Some(item));
        }
    }

    #[test]
    fn what_is_not_required_may_be_missing_but_an_unknown_value_never_passes() {
        let lenient = Requirements {
            enabled: false,
            zero_age_s: u32::MAX,
            shunt_passed: false,
            force_at_rest_n: u32::MAX,
            stroke_um: 0,
        };
        let bare = Readiness { enabled: false, shunt_passed: false, stroke_in_um: 0, ..READY };
        assert_eq!(bare.shortfall(&lenient), None);
        let unknown = Readiness { zero_age_s: None, ..bare };
        assert_eq!(unknown.shortfall(&lenient).map(|found| found.item), Some(ArmItem::ZeroAge));
    }
}
