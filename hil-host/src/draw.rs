//! Numbers that are drawn: those of a start and of a session.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use rustix::io::Errno;
use rustix::rand::{GetRandomFlags, getrandom};
use std::io;

/// A source of 32-bit numbers: seeded where a run is to be repeated bit for bit, from the operating
/// system on a real bus, always the same one where a log is to arm an emulated rig.
#[derive(Debug, Clone, PartialEq)]
pub struct Draw(Source);

#[derive(Debug, Clone, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "one per rig, made once")]
enum Source {
    Generator(ChaCha8Rng),
    Repeating(u32),
}

impl Draw {
    /// Always the same numbers; streams of one seed are independent (one per rig).
    pub fn seeded(seed: u64, stream: u64) -> Self {
        let mut source = ChaCha8Rng::seed_from_u64(seed);
        source.set_stream(stream);
        Self(Source::Generator(source))
    }

    /// Always this number. What it protects is gone: whoever has seen it can arm the rig again.
    pub const fn repeating(number: u32) -> Self {
        Self(Source::Repeating(number))
    }

    /// Numbers that nobody can foresee, from 256 bits of the operating system.
    ///
    /// # Errors
    /// The system has no random numbers.
    pub fn system() -> io::Result<Self> {
        let mut seed = [0_u8; 32];
        let mut filled = 0;
        while let Some(rest) = seed.get_mut(filled..).filter(|rest| !rest.is_empty()) {
            match getrandom(rest, GetRandomFlags::empty()) {
                Ok(count) => filled += count,
                Err(Errno::INTR) => {}
                Err(why) => return Err(why.into()),
            }
        }
        Ok(Self(Source::Generator(ChaCha8Rng::from_seed(seed))))
    }

    /// The next number.
    pub fn number(&mut self) -> u32 {
        match &mut self.0 {
            Source::Generator(generator) => generator.next_u32(),
            Source::Repeating(number) => *number,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_repeat_and_the_system_does_not() {
        let numbers = |mut draw: Draw| [draw.number(), draw.number()];
        assert_eq!(numbers(Draw::seeded(1, 2)), numbers(Draw::seeded(1, 2)));
        assert_ne!(numbers(Draw::seeded(1, 2)), numbers(Draw::seeded(1, 3)));
        assert_ne!(numbers(Draw::system().unwrap()), numbers(Draw::system().unwrap()));
    }
}
