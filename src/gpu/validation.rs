//! The validation layers: asked for, required, and every message kept.

use ash::vk;
use std::ffi::CStr;
use std::sync::{Arc, Mutex};

/// Messages of the validation layers, in order of arrival.
#[derive(Clone, Debug, Default)]
pub struct Messages(Arc<Mutex<Vec<String>>>);

impl Messages {
    /// What has been said so far.
    pub fn all(&self) -> Vec<String> {
        self.0.lock().map(|m| m.clone()).unwrap_or_default()
    }

    /// Adds a message of our own, a leak for instance: whoever fails on messages fails on it too.
    pub fn push(&self, message: String) {
        if let Ok(mut m) = self.0.lock() {
            m.push(message);
        }
    }

    pub(super) fn as_ptr(&self) -> *mut std::ffi::c_void {
        Arc::as_ptr(&self.0).cast_mut().cast()
    }
}

/// Prints at once, because a missing binding crashes some drivers right after the message, and keeps the text.
pub(super) unsafe extern "system" fn callback(
    severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _kinds: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    user: *mut std::ffi::c_void,
) -> vk::Bool32 {
    // SAFETY: the loader passes a valid structure, whose message is a C string; `user` is the Mutex inside the Arc that the
    // device keeps alive for as long as the messenger exists.
    let (message, messages) = unsafe {
        (CStr::from_ptr((*data).p_message).to_string_lossy().into_owned(), &*user.cast::<Mutex<Vec<String>>>())
    };
    if severity >= vk::DebugUtilsMessageSeverityFlagsEXT::WARNING {
        eprintln!("validation: {message}");
        if let Ok(mut m) = messages.lock() {
            m.push(message);
        }
    }
    vk::FALSE
}
