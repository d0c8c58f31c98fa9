//! Track: the irregularity that a locomotive without memory for its whole track is handed.
//!
//! ```text
//! locomotive                                   track server
//! TRACK_REQUEST count 0: which track?     ->
//!                                         <-   TRACK_OFFER first, step, samples, ways, fingerprint
//! TRACK_REQUEST first 0, count 200        ->
//!                                         <-   TRACK_CENTRE_LINE 0, TRACK_RAILS 0
//!                                         <-   TRACK_CENTRE_LINE 1, ...
//! TRACK_REQUEST first 140, count 116      ->   as the vehicle runs on
//! ```
//!
//! Request and offer have the plain CRC and carry the number that the locomotive has drawn for
//! this session. Samples are sealed with the code of that number and the track's fingerprint
//! ([`TrackRequest::seal`]), in the place of the cycle stands the number of the sample. So a sample
//! of an old log, of another track or out of its order fails its CRC. The locomotive asks again
//! for whatever it has not got; no message is acknowledged.
//!
//! At 160 km/h and a sample every 0.1 m these are 889 frames per second, in the worst case 12 % of
//! a bus of 1 Mbit/s. Their ids lose against those of all that moves a rig.
mod fingerprint;
mod offer;
mod part;
mod request;
mod sample;

pub use fingerprint::TrackFingerprint;
pub use offer::{TrackItem, TrackOffer};
pub use part::TrackPart;
pub use request::TrackRequest;
pub use sample::TrackSample;
