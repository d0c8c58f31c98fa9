//! Whether two signals of a message share bits of a frame.
//!
//! Signals of different pages may lie on the same bits: no frame holds both. The selectors of a
//! multiplexed signal belong to it, since it is there by their values alone.

use crate::field::Field;
use crate::multiplex::Presence;
use crate::signal::Signal;

impl Signal {
    /// Whether some frame holds both signals, and they share bits of it.
    ///
    /// ```
    /// let text = "BO_ 1 M: 8 R\n SG_ P M : 0|2@1+ (1,0) [0|0] \"\" H\n \
    ///             SG_ A m1 : 8|8@1+ (1,0) [0|0] \"\" H\n \
    ///             SG_ B m2 : 8|8@1+ (1,0) [0|0] \"\" H\n SG_ C : 15|2@0+ (1,0) [0|0] \"\" H\n";
    /// let database = dbc::Database::from_text("a.dbc".as_ref(), text)?;
    /// let signal = |name| Ok::<_, dbc::DbcError>(database.signal(name)?.1.signal);
    /// assert!(!signal("A")?.overlaps(&signal("B")?));
    /// assert!(signal("A")?.overlaps(&signal("C")?));
    /// assert!(signal("A")?.overlaps(&signal("P")?) && signal("P")?.selects(&signal("A")?));
    /// # Ok::<(), dbc::DbcError>(())
    /// ```
    pub fn overlaps(&self, other: &Self) -> bool {
        !self.presence.excludes(&other.presence)
            && (share(self.field, other.field)
                || is_on(self.field, &other.presence)
                || is_on(other.field, &self.presence))
    }

    /// Whether it shares bits with its own selectors: writing it may take it out of its frame.
    pub(crate) fn is_on_its_selector(&self) -> bool {
        is_on(self.field, &self.presence)
    }

    /// Whether this signal is a selector of the other one.
    pub fn selects(&self, other: &Self) -> bool {
        let conditions = other.presence.conditions.iter().flatten();
        conditions.into_iter().any(|condition| condition.selector == self.field)
    }
}

/// Whether a field shares a bit with a selector.
fn is_on(field: Field, presence: &Presence) -> bool {
    presence.conditions.iter().flatten().any(|condition| share(field, condition.selector))
}

/// Whether two fields share a bit.
fn share(one: Field, other: Field) -> bool {
    let (one, other) = (one.mask(), other.mask());
    one.iter().zip(&other).any(|(one, other)| one & other != 0)
}
