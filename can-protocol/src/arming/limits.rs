//! The limits that host and rig agree on: of each pair the tighter one.
use super::item::ArmItem;
use super::refusal::Shortfall;

/// What a rig must not exceed in a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Stroke to either side of mid-stroke, µm.
    pub stroke_um: u32,
    /// Velocity, µm/s.
    pub velocity_um_per_s: u32,
    /// Acceleration, mm/s².
    pub acceleration_mm_per_s2: u32,
    /// Force, N.
    pub force_n: u32,
}

impl Limits {
    /// The items of the four limits.
    pub const ITEMS: [ArmItem; 4] =
        [ArmItem::Stroke, ArmItem::Velocity, ArmItem::Acceleration, ArmItem::Force];

    /// The limit of an item, `None` when the item is no limit.
    pub const fn get(&self, item: ArmItem) -> Option<u32> {
        match item {
            ArmItem::Stroke => Some(self.stroke_um),
            ArmItem::Velocity => Some(self.velocity_um_per_s),
            ArmItem::Acceleration => Some(self.acceleration_mm_per_s2),
            ArmItem::Force => Some(self.force_n),
            _ => None,
        }
    }

    /// Replaces the limit of an item; an item that is no limit changes nothing.
    pub(super) const fn set(&mut self, item: ArmItem, value: u32) {
        match item {
            ArmItem::Stroke => self.stroke_um = value,
            ArmItem::Velocity => self.velocity_um_per_s = value,
            ArmItem::Acceleration => self.acceleration_mm_per_s2 = value,
            ArmItem::Force => self.force_n = value,
            _ => {}
        }
    }

    /// Of each limit the tighter one.
    ///
    /// ```
    /// use can_protocol::arming::Limits;
    /// let host = Limits {
    ///     stroke_um: 20_000, velocity_um_per_s: 300_000,
    ///     acceleration_mm_per_s2: 9000, force_n: 30_000,
    /// };
    /// let rig = Limits { stroke_um: 50_000, force_n: 25_000, ..host };
    /// assert_eq!(host.tighter(rig), Limits { force_n: 25_000, ..host });
    /// ```
    #[must_use]
    pub fn tighter(self, other: Self) -> Self {
        Self {
            stroke_um: self.stroke_um.min(other.stroke_um),
            velocity_um_per_s: self.velocity_um_per_s.min(other.velocity_um_per_s),
            acceleration_mm_per_s2: self.acceleration_mm_per_s2.min(other.acceleration_mm_per_s2),
            force_n: self.force_n.min(other.force_n),
        }
    }

    /// The first limit that is tighter than a run needs.
    pub fn shortfall(&self, needed: &Self) -> Option<Shortfall> {
        Self::ITEMS.into_iter().find_map(|item| {
            let (found, needed) = (self.get(item)?, needed.get(item)?);
            (found < needed).then_some(Shortfall { item, found, needed })
        })
    }
}
