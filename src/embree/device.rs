//! An Embree device: configuration, errors and the memory it holds.

#![allow(unsafe_code)]

use super::config::{Config, Width};
use super::error::{EmbreeError, describe};
use embree_sys as sys;
use std::ffi::{CStr, CString, c_char, c_void};
use std::sync::atomic::{AtomicI64, Ordering::Relaxed};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Bytes Embree holds: trees and temporaries, not the mesh's buffers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Memory {
    /// Held now.
    pub live_bytes: usize,
    /// Most held at a time since the device was made or [`Device::reset_peak`].
    pub peak_bytes: usize,
}

/// Counters and errors that Embree's callbacks write, from any of its threads.
#[derive(Default)]
struct Monitor {
    live: AtomicI64,
    peak: AtomicI64,
    /// The first error since the last check.
    error: Mutex<Option<String>>,
}

/// An Embree device, made for one [`Config`]. Its scenes share it: it is released with the last of them.
#[derive(Clone)]
pub struct Device(Arc<Shared>);

/// What a device and its scenes share.
struct Shared {
    raw: sys::RTCDevice,
    /// Outlives `raw`, which holds a pointer to it.
    monitor: Arc<Monitor>,
    config: String,
}

// SAFETY: a device is not bound to the thread that made it; its reference count is atomic.
unsafe impl Send for Shared {}
// SAFETY: through `&Shared` only new scenes and geometries are made, properties and errors read. Embree allows
// these calls from several threads (its rule: one thread at a time per scene or geometry, and errors are kept
// per thread); the monitor is made of atomics and a mutex.
unsafe impl Sync for Shared {}

impl Device {
    /// A device that builds with `config`. Unknown CPUs' limits show when a scene is committed.
    ///
    /// # Errors
    /// [`EmbreeError::Device`].
    pub fn new(config: &Config) -> Result<Self, EmbreeError> {
        Self::from_string(config.device_string())
    }

    /// A device for [`Prepared::robust`](super::scene::Prepared::robust) scenes, whose leaves hold whole triangles:
    /// of the width of `config`, built by SAH.
    ///
    /// # Errors
    /// [`EmbreeError::Device`].
    pub fn robust(config: &Config) -> Result<Self, EmbreeError> {
        Self::from_string(config.robust_string())
    }

    /// A device whose scenes are built geometry by geometry (`tri_builder=dynamic`), each by its own quality: that of
    /// refitting is one of a geometry.
    pub(super) fn refitting(width: Width, threads: usize) -> Result<Self, EmbreeError> {
        let lanes = width.lanes();
        Self::from_string(format!("threads={threads},tri_accel=bvh{lanes}.triangle4,tri_builder=dynamic"))
    }

    /// A device that builds with `config` and takes kernels for no more than the instruction set `isa`, as Embree
    /// writes it (`avx2`).
    ///
    /// # Errors
    /// [`EmbreeError::Device`], also for what can be no name of an instruction set.
    pub fn limited(config: &Config, isa: &str) -> Result<Self, EmbreeError> {
        let config = format!("{},max_isa={isa}", config.device_string());
        // Another option, behind a comma, might make leaves of another form.
        if !isa.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"._".contains(&byte)) {
            return Err(EmbreeError::Device { config, reason: "no instruction set has such a name" });
        }
        Self::from_string(config)
    }

    /// A device from any device string.
    pub(super) fn from_string(config: String) -> Result<Self, EmbreeError> {
        let Ok(string) = CString::new(config.as_str()) else {
            return Err(EmbreeError::Device { config, reason: "the string holds a NUL" });
        };
        // SAFETY: the string is NUL-terminated and only read during the call.
        let raw = unsafe { sys::rtcNewDevice(string.as_ptr()) };
        if raw.is_null() {
            // SAFETY: a null device asks for the error of the last failed creation on this thread.
            let code = unsafe { sys::rtcGetDeviceError(std::ptr::null_mut()) };
            return Err(EmbreeError::Device { config, reason: describe(code) });
        }
        let monitor = Arc::new(Monitor::default());
        let user = Arc::as_ptr(&monitor).cast_mut().cast::<c_void>();
        // SAFETY: `raw` is a live device. The callbacks read `user` as the `Monitor` it is, shared and for as
        // long as the device lives: `drop` releases the device before the monitor.
        unsafe {
            sys::rtcSetDeviceErrorFunction(raw, Some(on_error), user);
            sys::rtcSetDeviceMemoryMonitorFunction(raw, Some(on_memory), user);
        }
        Ok(Self(Arc::new(Shared { raw, monitor, config })))
    }

    /// Bytes held now and at most.
    pub fn memory(&self) -> Memory {
        let bytes = |counter: &AtomicI64| counter.load(Relaxed).max(0) as usize;
        Memory { live_bytes: bytes(&self.0.monitor.live), peak_bytes: bytes(&self.0.monitor.peak) }
    }

    /// Forgets the peak: it starts again from the bytes held now. Call it while nothing is being built.
    pub fn reset_peak(&self) {
        self.0.monitor.peak.store(self.0.monitor.live.load(Relaxed), Relaxed);
    }

    /// The device string.
    pub fn config(&self) -> &str {
        &self.0.config
    }

    /// Version of the library in use, as 10000 major + 100 minor + patch.
    pub(super) fn version_number(&self) -> isize {
        // SAFETY: the device is live.
        unsafe { sys::rtcGetDeviceProperty(self.0.raw, sys::RTC_DEVICE_PROPERTY_VERSION) }
    }

    pub(super) fn raw(&self) -> sys::RTCDevice {
        self.0.raw
    }

    /// The first error on this thread since the last check.
    pub(super) fn check(&self, doing: &'static str) -> Result<(), EmbreeError> {
        // SAFETY: the device is live.
        let code = unsafe { sys::rtcGetDeviceError(self.0.raw) };
        // Before the text is taken, which may be for another thread.
        if code == sys::RTC_ERROR_NONE {
            return Ok(());
        }
        let text = self.0.monitor.error.lock().unwrap_or_else(PoisonError::into_inner).take();
        let text = text.unwrap_or_else(|| describe(code).to_owned());
        Err(EmbreeError::Call { doing, text, config: self.0.config.clone() })
    }
}

impl Drop for Shared {
    fn drop(&mut self) {
        // SAFETY: the last use of this device: every scene holds it and is gone. The monitor still
        // lives, so callbacks during the release are sound.
        unsafe { sys::rtcReleaseDevice(self.raw) };
    }
}

/// Keeps Embree's text of the first error.
///
/// # Safety
/// `user` points to a live [`Monitor`], `text` is null or NUL-terminated.
unsafe extern "C" fn on_error(user: *mut c_void, code: sys::RTCError, text: *const c_char) {
    // SAFETY: the caller's promise.
    let monitor = unsafe { &*user.cast::<Monitor>() };
    let text = if text.is_null() {
        describe(code).to_owned()
    } else {
        // SAFETY: the caller's promise.
        unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()
    };
    monitor.error.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(text);
}

/// Counts an allocation (or, negative, a release) and allows it.
///
/// # Safety
/// `user` points to a live [`Monitor`].
unsafe extern "C" fn on_memory(user: *mut c_void, bytes: isize, _after: bool) -> bool {
    // SAFETY: the caller's promise.
    let monitor = unsafe { &*user.cast::<Monitor>() };
    let live = monitor.live.fetch_add(bytes as i64, Relaxed) + bytes as i64;
    monitor.peak.fetch_max(live, Relaxed);
    true
}

/// A version as [`Device::version_number`] gives it, as it is written: 31305 is "3.13.5".
pub(super) fn version_name(number: isize) -> String {
    format!("{}.{}.{}", number / 10000, number / 100 % 100, number % 100)
}

/// The version of the library in use, e.g. "3.13.5" or "4.3.3", or why it cannot be asked.
pub fn version() -> String {
    static VERSION: OnceLock<String> = OnceLock::new();
    let ask = || match Device::from_string("threads=1".to_owned()) {
        Ok(device) => version_name(device.version_number()),
        Err(why) => why.to_string(),
    };
    VERSION.get_or_init(ask).clone()
}
