//! Every error that ends `capture` has its code in the log and its exit code. One test, because the newest code belongs to the
//! whole process.

use andon_host::exit::Code;
use andon_host::log::last_error;
use andon_host::role::Failure as _;
use andon_video::{CaptureError, OpenError};

fn open(why: fn(String) -> OpenError) -> CaptureError {
    why("/dev/video0".into()).into()
}

#[test]
fn every_error_of_capture_has_its_code_and_its_exit_code() {
    let errors = [
        (open(OpenError::Refused), 105, Code::Configuration),
        (open(OpenError::NotAllowed), 107, Code::Fault),
        (open(OpenError::Gone), 108, Code::Fault),
        (open(OpenError::NoRecording), 108, Code::Configuration),
        (CaptureError::Source(String::new()), 108, Code::Fault),
        (open(OpenError::Unfit), 109, Code::Fault),
        (open(OpenError::Unsupported), 109, Code::Configuration),
    ];
    for (error, code, exit) in errors {
        assert_eq!((error.report(), last_error()), (exit, code), "{error}");
    }
}
