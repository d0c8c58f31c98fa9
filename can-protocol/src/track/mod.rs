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
//! this session. Samples are sealed ([`TrackSeal`]) with that number, the fingerprint of the track
//! and their place on it. So a sample of an old log, of another track or out of its order fails its
//! CRC but for chance. The locomotive asks again for whatever it has not got, and now and then
//! which track this is; no message is acknowledged.
//!
//! At 160 km/h and a sample every 0.1 m these are 889 frames per second and 28 requests, in the
//! worst case 12.4 % of a bus of 1 Mbit/s. A server sends two frames in a cycle at most: 27 % while
//! a window fills. Their ids lose against commands, measurements and faults.
mod fingerprint;
mod offer;
mod part;
mod request;
mod sample;
mod seal;

pub use fingerprint::TrackFingerprint;
pub use offer::{TrackItem, TrackOffer};
pub use part::TrackPart;
pub use request::TrackRequest;
pub use sample::TrackSample;
pub use seal::TrackSeal;
