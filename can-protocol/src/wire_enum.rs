//! Closed lists of codes: the enums that travel as a number.
//!
//! [`wire_enum!`] writes an enum from one table of variant, code and name, so that code, name and
//! the way back cannot disagree. A code that is not in the table is reserved: reading it is an
//! error ([`Word::code`](crate::signal::Word::code)).

/// An enum that travels as a code.
pub(crate) trait WireEnum: Sized {
    /// The field that it fills, as errors name it.
    const FIELD: &'static str;

    /// The value of a code, `None` for a reserved one.
    fn of_code(code: u32) -> Option<Self>;
}

/// Writes an enum with its codes on the wire and its names in the DBC.
macro_rules! wire_enum {
    (
        $(#[$doc:meta])*
        $name:ident in $field:literal {
            $($(#[$variant_doc:meta])* $variant:ident = $code:literal, $text:literal;)+
        }
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[repr(u8)]
        pub enum $name {
            $($(#[$variant_doc])* $variant = $code,)+
        }

        impl $name {
            /// All values in the order of their codes.
            pub const ALL: [Self; [$($code),+].len()] = [$(Self::$variant),+];

            /// The code on the wire.
            pub const fn code(self) -> u8 {
                self as u8
            }

            /// The value of a code, `None` for a reserved one.
            pub const fn from_code(code: u8) -> Option<Self> {
                match code {
                    $($code => Some(Self::$variant),)+
                    _ => None,
                }
            }

            /// The name in the DBC.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $text,)+
                }
            }
        }

        impl $crate::wire_enum::WireEnum for $name {
            const FIELD: &'static str = $field;

            fn of_code(code: u32) -> Option<Self> {
                u8::try_from(code).ok().and_then(Self::from_code)
            }
        }

        impl core::fmt::Display for $name {
            fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                f.write_str(self.name())
            }
        }
    };
}

pub(crate) use wire_enum;

#[cfg(test)]
mod tests {
    use super::WireEnum;
    use crate::{Mode, Pace, Pressure, RunState, Watch};

    fn is_one_to_one<T: WireEnum + Copy + PartialEq + core::fmt::Debug>(
        all: &[T],
        code_of: impl Fn(T) -> u8,
    ) {
        for code in 0..=u32::from(u8::MAX) + 1 {
            match T::of_code(code) {
                Some(value) => assert_eq!(u32::from(code_of(value)), code),
                None => assert!(code >= all.len() as u32, "{} {code}", T::FIELD),
            }
        }
        for (place, value) in all.iter().enumerate() {
            assert_eq!(T::of_code(place as u32), Some(*value));
        }
    }

    #[test]
    fn codes_and_values_are_one_to_one() {
        is_one_to_one(&RunState::ALL, RunState::code);
        is_one_to_one(&Mode::ALL, Mode::code);
        is_one_to_one(&Pressure::ALL, Pressure::code);
        is_one_to_one(&Watch::ALL, Watch::code);
        is_one_to_one(&Pace::ALL, Pace::code);
    }
}
