//! Errors of Embree, with its own texts.

use embree_sys as sys;

/// Why Embree or this wrapper failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EmbreeError {
    /// No device could be made; Embree gives no text here.
    #[error("Embree made no device from \"{config}\": {reason}; check the device string's values")]
    Device {
        /// The device string.
        config: String,
        /// The error code, in words.
        reason: &'static str,
    },
    /// A call failed.
    #[error("Embree failed while {doing}: {text} (device \"{config}\")")]
    Call {
        /// The call.
        doing: &'static str,
        /// Embree's own text.
        text: String,
        /// The device string.
        config: String,
    },
    /// A scene to be instanced was made by another device.
    #[error("instance {0} is of a scene of another device; make both with one device")]
    OtherDevice(usize),
    /// A transform that is not finite or cannot be inverted.
    #[error("the transform of instance {0} cannot be inverted; leave the instance out")]
    Transform(usize),
    /// Another builder ran than was asked for.
    #[error(
        "Embree built {found} where {wanted} was asked for; another version or CPU than the device string is for?"
    )]
    WrongBuilder {
        /// Accel and builder asked for.
        wanted: String,
        /// Accel and builder reported.
        found: String,
    },
    /// The verbose output lacks something.
    #[error("Embree's verbose output names no {0}; another version than 3.13 or 4.3?")]
    Unreadable(&'static str),
    /// Standard output could not be redirected to read the verbose output.
    #[error("standard output could not be read back: {0}; is it closed?")]
    Capture(#[from] std::io::Error),
}

/// An error code in words, for errors that come without a text.
pub(super) fn describe(code: sys::RTCError) -> &'static str {
    match code {
        sys::RTC_ERROR_NONE => "no error",
        sys::RTC_ERROR_INVALID_ARGUMENT => "invalid argument",
        sys::RTC_ERROR_INVALID_OPERATION => "invalid operation",
        sys::RTC_ERROR_OUT_OF_MEMORY => "out of memory",
        sys::RTC_ERROR_UNSUPPORTED_CPU => "unsupported CPU",
        sys::RTC_ERROR_CANCELLED => "cancelled",
        _ => "unknown error",
    }
}
