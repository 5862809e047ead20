//! An OpenGL context without a window: EGL, loaded at run time.
//!
//! In: nothing but the system. Out: a context of OpenGL's compatibility profile that is current on the calling thread, and
//! the addresses of GL functions. Tried in order: the surfaceless platform (EGL_MESA_platform_surfaceless), then every
//! device of EGL_EXT_platform_device. `khronos-egl` opens libEGL with `dlopen`, so nothing is linked.
//!
//! The display stays initialised until the process ends: EGL has one for the whole process, and other threads may use it.
#![allow(unsafe_code, reason = "EGL is a C library")]

use std::ffi::{CStr, c_void};
use std::ptr::null_mut;

use khronos_egl as egl;

/// EGL_PLATFORM_SURFACELESS_MESA.
const PLATFORM_SURFACELESS: egl::Enum = 0x31DD;
/// EGL_PLATFORM_DEVICE_EXT.
const PLATFORM_DEVICE: egl::Enum = 0x313F;
/// More devices than any machine has.
const MAX_DEVICES: usize = 32;

/// A C function of unknown type.
pub(super) type Address = extern "system" fn();
/// eglQueryDevicesEXT.
type QueryDevices =
    unsafe extern "system" fn(egl::Int, *mut *mut c_void, *mut egl::Int) -> egl::Boolean;
type Egl = egl::DynamicInstance<egl::EGL1_5>;

/// An OpenGL context.
pub(super) struct Context {
    egl: Egl,
    display: egl::Display,
    context: egl::Context,
    surface: Option<egl::Surface>,
    /// How it was found: "surfaceless" or "device N".
    pub(super) platform: String,
}

impl Context {
    /// Opens a context and makes it current on this thread.
    ///
    /// # Errors
    /// A sentence that says what is missing.
    pub(super) fn open() -> Result<Self, String> {
        // SAFETY: the library that the system has under the name of libEGL is trusted to be EGL; its version is checked.
        let egl = unsafe { Egl::load_required() }.map_err(|e| format!("no EGL 1.5: {e}"))?;
        let mut failures = Vec::new();
        for (name, platform, native) in candidates(&egl) {
            match open_on(&egl, platform, native) {
                Ok((display, context, surface)) => {
                    return Ok(Self {
                        egl,
                        display,
                        context,
                        surface,
                        platform: name,
                    });
                }
                Err(reason) => failures.push(format!("{name}: {reason}")),
            }
        }
        if failures.is_empty() {
            return Err("EGL has neither the surfaceless nor the device platform".to_owned());
        }
        Err(failures.join("; "))
    }

    /// Makes the context current on this thread.
    pub(super) fn make_current(&self) -> Result<(), String> {
        make_current(&self.egl, self.display, self.surface, self.context)
    }

    /// The address of a GL function, where the driver knows one of this name.
    pub(super) fn address(&self, name: &str) -> Option<Address> {
        self.egl.get_proc_address(name)
    }
}

impl Drop for Context {
    fn drop(&mut self) {
        // Nothing is left to do where the driver refuses to let go.
        let _ = self.egl.make_current(self.display, None, None, None);
        if let Some(surface) = self.surface {
            let _ = self.egl.destroy_surface(self.display, surface);
        }
        let _ = self.egl.destroy_context(self.display, self.context);
    }
}

/// Platforms to try: their names, enumerants and native displays.
fn candidates(egl: &Egl) -> Vec<(String, egl::Enum, *mut c_void)> {
    let extensions = egl.query_string(None, egl::EXTENSIONS);
    let extensions = extensions.map(CStr::to_string_lossy).unwrap_or_default();
    let has = |name: &str| extensions.split_whitespace().any(|e| e == name);
    let mut found = Vec::new();
    if has("EGL_MESA_platform_surfaceless") {
        found.push((
            "surfaceless".to_owned(),
            PLATFORM_SURFACELESS,
            egl::DEFAULT_DISPLAY,
        ));
    }
    if has("EGL_EXT_platform_device") {
        let devices = devices(egl).into_iter().enumerate();
        found.extend(devices.map(|(i, device)| (format!("device {i}"), PLATFORM_DEVICE, device)));
    }
    found
}

/// The devices of EGL_EXT_device_enumeration.
fn devices(egl: &Egl) -> Vec<*mut c_void> {
    let Some(address) = egl.get_proc_address("eglQueryDevicesEXT") else {
        return Vec::new();
    };
    // SAFETY: EGL gave this address for a function that the extension declares with this type.
    let query = unsafe { std::mem::transmute::<Address, QueryDevices>(address) };
    let (mut list, mut count) = ([null_mut(); MAX_DEVICES], 0);
    // SAFETY: the list has room for as many pointers as the first argument says.
    let known = unsafe { query(MAX_DEVICES as egl::Int, list.as_mut_ptr(), &raw mut count) };
    if known != egl::TRUE {
        return Vec::new();
    }
    list[..(count.max(0) as usize).min(MAX_DEVICES)].to_vec()
}

/// A display, a context on it, and a surface where the driver needs one.
type Opened = (egl::Display, egl::Context, Option<egl::Surface>);

fn open_on(egl: &Egl, platform: egl::Enum, native: *mut c_void) -> Result<Opened, String> {
    let failed = |what: &'static str| move |e: egl::Error| format!("{what}: {e}");
    // SAFETY: the surfaceless platform takes the default display, the device platform a device that EGL itself listed.
    let display = unsafe { egl.get_platform_display(platform, native, &[egl::ATTRIB_NONE]) };
    let display = display.map_err(failed("no display"))?;
    egl.initialize(display)
        .map_err(failed("cannot initialise"))?;
    egl.bind_api(egl::OPENGL_API)
        .map_err(failed("no OpenGL, only OpenGL ES"))?;
    let wanted = [
        egl::SURFACE_TYPE,
        egl::PBUFFER_BIT,
        egl::RENDERABLE_TYPE,
        egl::OPENGL_BIT,
        egl::NONE,
    ];
    let config = egl.choose_first_config(display, &wanted);
    let config = config
        .map_err(failed("no configuration"))?
        .ok_or_else(|| "no configuration for OpenGL".to_owned())?;
    // Below 3.2 there are no profiles: what answers has the fixed functions, in whatever newer version.
    let version = [
        egl::CONTEXT_MAJOR_VERSION,
        2,
        egl::CONTEXT_MINOR_VERSION,
        1,
        egl::NONE,
    ];
    let context = egl
        .create_context(display, config, None, &version)
        .map_err(failed("no OpenGL 2.1 context"))?;
    if make_current(egl, display, None, context).is_ok() {
        return Ok((display, context, None));
    }
    // Without EGL_KHR_surfaceless_context a surface is needed, though nothing is drawn on it.
    let size = [egl::WIDTH, 1, egl::HEIGHT, 1, egl::NONE];
    let surface = egl.create_pbuffer_surface(display, config, &size).ok();
    match make_current(egl, display, surface, context) {
        Ok(()) => Ok((display, context, surface)),
        Err(reason) => {
            if let Some(surface) = surface {
                let _ = egl.destroy_surface(display, surface);
            }
            let _ = egl.destroy_context(display, context);
            Err(reason)
        }
    }
}

fn make_current(
    egl: &Egl,
    display: egl::Display,
    surface: Option<egl::Surface>,
    context: egl::Context,
) -> Result<(), String> {
    // Contexts of OpenGL and OpenGL ES are bound apart; which one is meant is a setting of the thread.
    egl.bind_api(egl::OPENGL_API)
        .and_then(|()| egl.make_current(display, surface, surface, Some(context)))
        .map_err(|e| format!("the context cannot be made current: {e}"))
}
