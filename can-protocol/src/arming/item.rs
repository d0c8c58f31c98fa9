//! The items of the arming exchange: what one message asks or answers.
use crate::wire_enum::WireEnum;

macro_rules! arm_items {
    ($($(#[$doc:meta])* $variant:ident = $code:literal, $name:literal;)*) => {
        /// One item, as the 16-bit code on the wire: the page is the high byte, the place on the
        /// page the low byte. Other codes are reserved.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[repr(u16)]
        pub enum ArmItem {
            $($(#[$doc])* $variant = $code,)*
        }

        impl ArmItem {
            /// All items in the order of their codes.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];

            /// The code on the wire.
            pub const fn code(self) -> u16 {
                self as u16
            }

            /// The item of a code, `None` for a reserved one.
            pub const fn from_code(code: u16) -> Option<Self> {
                match code {
                    $($code => Some(Self::$variant),)*
                    _ => None,
                }
            }

            /// The name in the DBC.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name,)*
                }
            }
        }
    };
}

arm_items! {
    /// The host opens an exchange with its number; the rig answers with [`ArmItem::RigNumber`].
    HostNumber = 0x0101, "HOST_NUMBER";
    /// The fresh number of the rig.
    RigNumber = 0x0102, "RIG_NUMBER";
    /// Largest stroke to either side of mid-stroke, µm. Asked by the host, answered with the
    /// tighter of both.
    Stroke = 0x0201, "STROKE_UM";
    /// Largest velocity, µm/s; asked and answered likewise.
    Velocity = 0x0202, "VELOCITY_UM_PER_S";
    /// Largest acceleration, mm/s²; asked and answered likewise.
    Acceleration = 0x0203, "ACCELERATION_MM_PER_S2";
    /// Largest force, N; asked and answered likewise.
    Force = 0x0204, "FORCE_N";
    /// Asked with 0; the rig answers with its boot number, the same as in its heartbeat.
    Alive = 0x0301, "ALIVE";
    /// Asked with 0; 1 when the rig's key switch enables motion, else 0.
    Enabled = 0x0302, "ENABLED";
    /// Asked with 0; age of the load cell's zero in s, all ones when none was taken.
    ZeroAge = 0x0303, "ZERO_AGE_S";
    /// Asked with 0; 1 when the shunt check of the load cell passed, else 0.
    ShuntCheck = 0x0304, "SHUNT_CHECK";
    /// Asked with 0; magnitude of the force at rest in N, all ones when it is not known.
    ForceAtRest = 0x0305, "FORCE_AT_REST_N";
    /// Asked with 0; stroke left in extension, the nearer of ram and damper, µm.
    StrokeOut = 0x0306, "STROKE_LEFT_OUT_UM";
    /// Asked with 0; stroke left in compression, likewise.
    StrokeIn = 0x0307, "STROKE_LEFT_IN_UM";
    /// The host sends the hash of its configuration; the rig answers with its own.
    Configuration = 0x0401, "CONFIGURATION_HASH";
    /// The host arms the rig: number of the rig xor configuration hash. The rig answers with
    /// [`ArmItem::Armed`], [`ArmItem::Quiet`] or [`ArmItem::Refused`].
    Arm = 0x0501, "ARM";
    /// The rig is armed: number of the host xor configuration hash.
    Armed = 0x0502, "ARMED";
    /// Not yet: the cycles that the bus must stay quiet before the rig arms. Ask again then.
    Quiet = 0x0503, "QUIET_CYCLES";
    /// The rig refuses; the value is the code of the item that stands against it.
    Refused = 0x0504, "REFUSED";
    /// As a reason only: the rig's run state is not STANDBY.
    State = 0x0505, "STATE";
    /// The host resets a latched rig (`yawbench rig-reset`): number of the rig. The rig answers
    /// with the number of the host, or with [`ArmItem::Refused`].
    Reset = 0x0601, "RESET";
}

impl WireEnum for ArmItem {
    const FIELD: &'static str = "item";

    fn of_code(code: u32) -> Option<Self> {
        u16::try_from(code).ok().and_then(Self::from_code)
    }
}

impl core::fmt::Display for ArmItem {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_and_items_are_one_to_one() {
        for code in 0..=u16::MAX {
            if let Some(item) = ArmItem::from_code(code) {
                assert_eq!(item.code(), code);
                assert!(ArmItem::ALL.contains(&item));
            }
        }
        assert!(ArmItem::ALL.is_sorted());
    }
}
