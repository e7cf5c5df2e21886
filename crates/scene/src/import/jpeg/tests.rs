//! Complete files, and files that end early.

use super::{DAMAGED, EARLY, check};
use base64::{Engine, engine::general_purpose::STANDARD};

/// Files of 21 by 19 pixels by libjpeg, with color at half the resolution and restarts: one sequential, one
/// progressive.
const SEQUENTIAL: &str = "\
    /9j/4AAQSkZJRgABAQAAAQABAAD/2wBDABALDA4MChAODQ4SERATGCgaGBYWGDEjJR0oOjM9PDkzODdASFxOQERXRTc4UG1RV19iZ2hnPk1xeX\
    BkeFxlZ2P/2wBDARESEhgVGC8aGi9jQjhCY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2P/wAARCAAT\
    ABUDASIAAhEBAxEB/8QAGQABAQADAQAAAAAAAAAAAAAAAAUCAwYE/8QAHxAAAQQCAwEBAAAAAAAAAAAAAQACAyEEEQUSMUGx/8QAFwEAAwEAAA\
    AAAAAAAAAAAAAAAgMEBf/EACARAAICAQMFAAAAAAAAAAAAAAECAAMEEiFBBRExMjP/3QAEAAL/2gAMAwEAAhEDEQA/AKvKFsON83pcPMDPl0B6\
    up5eV0reouvFDjh6ydik4KLXV43hYhOU+lfUS3xuO0YwoCgi1Q5RbGAw6CKa2tWckg7x1mRVWxQcT//Q9UrGujHYbpSMxoBr9RFTjopUdxxGdF\
    2x2mWNbDtERG4GozCu+hn/2Q==";
const PROGRESSIVE: &str = "\
    /9j/4AAQSkZJRgABAQAAAQABAAD/2wBDABALDA4MChAODQ4SERATGCgaGBYWGDEjJR0oOjM9PDkzODdASFxOQERXRTc4UG1RV19iZ2hnPk1xeX\
    BkeFxlZ2P/2wBDARESEhgVGC8aGi9jQjhCY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2P/wgARCAAT\
    ABUDASIAAhEBAxEB/8QAGAABAAMBAAAAAAAAAAAAAAAAAAIDBAX/xAAXAQADAQAAAAAAAAAAAAAAAAACAwQB/90ABAAB/9oADAMBAAIQAxAAAA\
    HVw+rhDf/QkinZ/9G3GML/0qQ6L//EABsQAAIDAAMAAAAAAAAAAAAAAAECAAMhESIx/9oACAEBAAEFArcX/9A63//RrXr/AP/StPM//9MDf//U\
    DZ//1T5//9Z5/9dZ/8QAHREAAgIBBQAAAAAAAAAAAAAAAAECAxEEIzEyM//aAAgBAwEBPwGrdeFwf//QlZGLwf/R0Xmz/9KfY//EABkRAQADAQ\
    EAAAAAAAAAAAAAAAEAAgMRMf/aAAgBAgEBPwHAK1n/0LVFn//RzDk//9J9n//EABQQAQAAAAAAAAAAAAAAAAAAAAD/2gAIAQEABj8Cf//Qf//R\
    f//Sf//Tf//Uf//Vf//Wf//Xf//EABgQAQEBAQEAAAAAAAAAAAAAAAABESEx/9oACAEBAAE/IcL/0H//0ZH/0rRj/9PHT//Uz4f/1Yl6f//Wh/\
    /X8P/aAAwDAQACAAMAAAAQw//Qy//Re//S9//EABgRAAMBAQAAAAAAAAAAAAAAAAABQSEx/9oACAEDAQE/EHcQf//QZFh//9HAf//S6H//xAAZ\
    EQEBAAMBAAAAAAAAAAAAAAABABEhMUH/2gAIAQIBAT8Q4nd//9Bio7v/0VDJ5f/SJlf/xAAaEAEAAwEBAQAAAAAAAAAAAAABABEhMUGx/9oACA\
    EBAAE/EF4bqf/QDmHZ/9EBwMJ//9KtNzk//9PQT//UQB0T/9UxS8n/1gHPs//X27n/2Q==";

fn files() -> [Vec<u8>; 2] {
    [SEQUENTIAL, PROGRESSIVE].map(|text| STANDARD.decode(text).expect("base64"))
}

/// Seen to catch: a block too few; bits of a run of blocks not read; a refinement that reads no bits of known
/// coefficients; padding taken for data.
#[test]
fn a_file_is_whole_or_refused() {
    for whole in files() {
        assert_eq!(check(&whole), Ok(()));
        for length in 0..whole.len() {
            assert!(check(&whole[..length]).is_err(), "{length} of {}", whole.len());
        }
        let with_more = [&whole[..], b"a second picture"].concat();
        assert_eq!(check(&with_more), Ok(()));
    }
}

/// An end marker after too little data, so that the file does not end early. A progressive file may end after any scan:
/// it is complete, with fewer details.
#[test]
fn data_that_ends_early_is_refused_though_the_end_is_marked() {
    for whole in files() {
        let scan = whole.windows(2).position(|w| w == [0xff, 0xda]).expect("a scan") + 14;
        for length in scan..whole.len() - 3 {
            let cut = [&whole[..length], &[0xff, 0xd9]].concat();
            let between = matches!(whole[length - 1..], [0xff, ..] | [_, 0xff, 0xc4 | 0xda, ..]);
            assert!(between || check(&cut).is_err(), "{length} of {}", whole.len());
        }
    }
}

/// A changed bit may change a color, which no reader can notice; most changes are noticed.
#[test]
fn damage_is_refused_or_harmless_and_never_a_panic() {
    for whole in files() {
        let (mut early, mut damaged) = (0, 0);
        for bit in 0..8 * whole.len() {
            let mut bytes = whole.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            match check(&bytes) {
                Err(EARLY) => early += 1,
                Err(DAMAGED) => damaged += 1,
                _ => {}
            }
        }
        assert!(early > 100 && damaged > 300, "{early} {damaged} of {}", 8 * whole.len());
    }
}
