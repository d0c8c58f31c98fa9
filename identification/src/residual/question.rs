//! Answers to a question about a residual.

/// The answer to a question that the records may not be able to answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answer {
    /// Yes.
    Yes,
    /// No.
    No,
    /// These records cannot answer it, and why.
    NotTested(String),
}

impl Answer {
    /// True where the records answer the question.
    pub const fn is_tested(&self) -> bool {
        !matches!(self, Self::NotTested(_))
    }
}
