//! Tests over SocketCAN. They run on this kernel where it has CAN, else in a throw-away machine
//! (`cargo xtask vcan`).

#[path = "../support/opened.rs"]
mod opened;
#[path = "../support/record.rs"]
mod record;

mod doctor;
mod foreign;
mod interface;
mod participants;
mod peer;
mod replay;
mod rig;
mod several_rigs;
mod smoke;
mod track_server;
mod unstable;
