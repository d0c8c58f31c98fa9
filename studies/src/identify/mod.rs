//! From measured records to the effect that a damper model lacks.

pub mod candidate;
pub mod colour;
pub mod coordinate;
pub mod fit;
pub mod folds;
pub mod gram;
pub mod grey_box;
pub mod left_over;
pub mod screening;
pub mod search;
pub mod simulation;
pub mod start;
pub mod tests_at_hand;
pub mod trial;
