//! The programs as users start them.

mod at_hand;
mod bad_input;
mod balance;
mod bare;
mod continued;
mod crops;
mod display;
mod environment;
mod faults;
mod guide;
mod hostile;
#[cfg(unix)]
mod make;
mod mutations;
mod names;
mod note;
mod opaque;
mod orbit;
mod outlook;
mod outputs;
mod pipeline;
mod reference;
mod shards;
mod targets;
mod user_files;
mod user_media;
mod views;
