//! The GL functions that are used here, as safe methods on a context that is current.
//!
//! In: a [`Context`]. Out: [`Gl`]. Functions are found by name at run time; their types are those of the OpenGL 2.1
//! specification and of the extensions named at them. A call with wrong values is GL's own affair (glGetError); what
//! could touch memory that is not ours takes slices and checks their lengths.
#![allow(unsafe_code, reason = "OpenGL is a C library")]

use std::ffi::{CStr, CString, c_char, c_void};
use std::marker::PhantomData;
use std::ptr::null;

use super::egl::{Address, Context};

/// Declares functions of plain numbers: a method each, which is safe wherever the context is current.
macro_rules! functions {
    (
        values { $( $method:ident = $name:literal ( $( $arg:ident : $type:ty ),* ) $( -> $result:ty )?; )* }
        pointers { $( $field:ident = $pointer_name:literal ( $( $pointer_type:ty ),* ) $( -> $pointer_result:ty )?; )* }
    ) => {
        /// Addresses of the functions.
        struct Functions {
            $( $method: unsafe extern "system" fn($( $type ),*) $( -> $result )?, )*
            $( $field: unsafe extern "system" fn($( $pointer_type ),*) $( -> $pointer_result )?, )*
        }

        impl Functions {
            fn load(context: &Context) -> Result<Self, String> {
                let find = |names: &'static str| {
                    let mut found = names.split(' ').filter_map(|name| context.address(name));
                    found.next().ok_or_else(|| format!("the driver lacks {names}"))
                };
                Ok(Self {
                    $( $method: {
                        let address = find($name)?;
                        // SAFETY: GL gave this address for a function that its specification declares with this type.
                        unsafe { std::mem::transmute::<Address, unsafe extern "system" fn($( $type ),*) $( -> $result )?>(address) }
                    }, )*
                    $( $field: {
                        let address = find($pointer_name)?;
                        // SAFETY: GL gave this address for a function that its specification declares with this type.
                        unsafe { std::mem::transmute::<Address, unsafe extern "system" fn($( $pointer_type ),*) $( -> $pointer_result )?>(address) }
                    }, )*
                })
            }
        }

        impl Gl {
            $(
                #[doc = concat!("`", $name, "`")]
                pub(super) fn $method(&self, $( $arg: $type ),*) $( -> $result )? {
                    // SAFETY: the context is current on this thread, and numbers alone cannot make GL leave its memory.
                    unsafe { (self.functions.$method)($( $arg ),*) }
                }
            )*
        }
    };
}

functions! {
    values {
        enable = "glEnable"(capability: u32);
        disable = "glDisable"(capability: u32);
        viewport = "glViewport"(x: i32, y: i32, width: i32, height: i32);
        depth_range = "glDepthRange"(near: f64, far: f64);
        depth_func = "glDepthFunc"(function: u32);
        depth_mask = "glDepthMask"(write: u8);
        blend_func = "glBlendFunc"(source: u32, destination: u32);
        cull_face = "glCullFace"(face: u32);
        front_face = "glFrontFace"(winding: u32);
        shade_model = "glShadeModel"(model: u32);
        matrix_mode = "glMatrixMode"(mode: u32);
        load_identity = "glLoadIdentity"();
        clear_color = "glClearColor"(r: f32, g: f32, b: f32, a: f32);
        clear_depth = "glClearDepth"(depth: f64);
        clear = "glClear"(buffers: u32);
        light = "glLightf"(light: u32, name: u32, value: f32);
        light_model = "glLightModeli"(name: u32, value: i32);
        material = "glMaterialf"(face: u32, name: u32, value: f32);
        color_material = "glColorMaterial"(face: u32, mode: u32);
        clamp_color = "glClampColor glClampColorARB"(target: u32, clamp: u32);
        bind_framebuffer = "glBindFramebuffer"(target: u32, framebuffer: u32);
        bind_renderbuffer = "glBindRenderbuffer"(target: u32, renderbuffer: u32);
        renderbuffer_storage = "glRenderbufferStorage"(target: u32, format: u32, width: i32, height: i32);
        framebuffer_renderbuffer = "glFramebufferRenderbuffer"(target: u32, attachment: u32, kind: u32, renderbuffer: u32);
        check_framebuffer_status = "glCheckFramebufferStatus"(target: u32) -> u32;
        get_error = "glGetError"() -> u32;
        create_shader = "glCreateShader"(kind: u32) -> u32;
        compile_shader = "glCompileShader"(shader: u32);
        delete_shader = "glDeleteShader"(shader: u32);
        create_program = "glCreateProgram"() -> u32;
        attach_shader = "glAttachShader"(program: u32, shader: u32);
        link_program = "glLinkProgram"(program: u32);
        use_program = "glUseProgram"(program: u32);
        delete_program = "glDeleteProgram"(program: u32);
        vertex_4f = "glVertex4f"(x: f32, y: f32, z: f32, w: f32);
        normal_3f = "glNormal3f"(x: f32, y: f32, z: f32);
        color_4f = "glColor4f"(r: f32, g: f32, b: f32, a: f32);
        begin = "glBegin"(mode: u32);
        end = "glEnd"();
    }
    pointers {
        get_string = "glGetString"(u32) -> *const c_char;
        get_integer = "glGetIntegerv"(u32, *mut i32);
        load_matrix = "glLoadMatrixf"(*const f32);
        light_v = "glLightfv"(u32, u32, *const f32);
        light_model_v = "glLightModelfv"(u32, *const f32);
        material_v = "glMaterialfv"(u32, u32, *const f32);
        vertex_pointer = "glVertexPointer"(i32, u32, i32, *const c_void);
        normal_pointer = "glNormalPointer"(u32, i32, *const c_void);
        color_pointer = "glColorPointer"(i32, u32, i32, *const c_void);
        enable_array = "glEnableClientState"(u32);
        disable_array = "glDisableClientState"(u32);
        draw_arrays_raw = "glDrawArrays"(u32, i32, i32);
        read_pixels = "glReadPixels"(i32, i32, i32, i32, u32, u32, *mut c_void);
        gen_framebuffers = "glGenFramebuffers"(i32, *mut u32);
        delete_framebuffers = "glDeleteFramebuffers"(i32, *const u32);
        gen_renderbuffers = "glGenRenderbuffers"(i32, *mut u32);
        delete_renderbuffers = "glDeleteRenderbuffers"(i32, *const u32);
        shader_source = "glShaderSource"(u32, i32, *const *const c_char, *const i32);
        get_shader = "glGetShaderiv"(u32, u32, *mut i32);
        get_shader_log = "glGetShaderInfoLog"(u32, i32, *mut i32, *mut c_char);
        get_program = "glGetProgramiv"(u32, u32, *mut i32);
        get_program_log = "glGetProgramInfoLog"(u32, i32, *mut i32, *mut c_char);
        get_uniform_location = "glGetUniformLocation"(u32, *const c_char) -> i32;
        uniform_4fv = "glUniform4fv"(i32, i32, *const f32);
    }
}

/// A context, current on the thread that made it, with its functions.
pub(super) struct Gl {
    functions: Functions,
    /// Outlives every call through `functions`.
    context: Context,
    /// A context is current on one thread: neither `Send` nor `Sync`.
    _thread: PhantomData<*const ()>,
}

/// Bytes of a log that are kept.
const LOG: usize = 2000;

impl Gl {
    /// Opens a context and finds the functions.
    ///
    /// # Errors
    /// A sentence that says what is missing.
    pub(super) fn open() -> Result<Self, String> {
        let context = Context::open()?;
        let functions = Functions::load(&context)?;
        Ok(Self {
            functions,
            context,
            _thread: PhantomData,
        })
    }

    /// Where the context was found.
    pub(super) fn platform(&self) -> &str {
        &self.context.platform
    }

    /// Makes the context current again, should another have been in between.
    pub(super) fn make_current(&self) -> Result<(), String> {
        self.context.make_current()
    }

    /// A string of the driver; empty where it has none.
    pub(super) fn string(&self, name: u32) -> String {
        // SAFETY: the context is current; GL returns null or a static string that ends in 0.
        unsafe {
            let text = (self.functions.get_string)(name);
            if text.is_null() {
                String::new()
            } else {
                CStr::from_ptr(text).to_string_lossy().into_owned()
            }
        }
    }

    /// A number of the driver; 0 where it does not know the name.
    pub(super) fn integer(&self, name: u32) -> i32 {
        let mut values = [0; 16];
        // SAFETY: the context is current; no state that is asked for here has more than 16 numbers.
        unsafe { (self.functions.get_integer)(name, values.as_mut_ptr()) };
        values[0]
    }

    /// Replaces the current matrix; 16 numbers, column by column.
    pub(super) fn load_matrix(&self, matrix: &[f32; 16]) {
        // SAFETY: the context is current; GL reads 16 numbers.
        unsafe { (self.functions.load_matrix)(matrix.as_ptr()) }
    }

    /// Sets a parameter of a light; GL reads at most four numbers.
    pub(super) fn light_v(&self, light: u32, name: u32, values: &[f32; 4]) {
        // SAFETY: the context is current; no parameter of a light has more than four numbers.
        unsafe { (self.functions.light_v)(light, name, values.as_ptr()) }
    }

    /// Sets a parameter of the light model.
    pub(super) fn light_model_v(&self, name: u32, values: &[f32; 4]) {
        // SAFETY: the context is current; no parameter of the light model has more than four numbers.
        unsafe { (self.functions.light_model_v)(name, values.as_ptr()) }
    }

    /// Sets a parameter of a material.
    pub(super) fn material_v(&self, face: u32, name: u32, values: &[f32; 4]) {
        // SAFETY: the context is current; no parameter of a material has more than four numbers.
        unsafe { (self.functions.material_v)(face, name, values.as_ptr()) }
    }

    /// Draws separate triangles from vertex arrays: as many as all arrays have vertices for.
    pub(super) fn draw_triangles(&self, arrays: &Arrays) {
        let f = &self.functions;
        let count = arrays.positions.len().min(arrays.normals.len());
        let colors = arrays.colors.as_slice();
        let count = if colors.is_empty() {
            count
        } else {
            count.min(colors.len())
        };
        let count = i32::try_from(count).unwrap_or(i32::MAX);
        // SAFETY: the context is current. The arrays are alive until they are disabled again below, and each has `count`
        // elements of the stated number of f32 without gaps.
        unsafe {
            (f.vertex_pointer)(3, FLOAT, 0, arrays.positions.as_ptr().cast());
            (f.enable_array)(VERTEX_ARRAY);
            (f.normal_pointer)(FLOAT, 0, arrays.normals.as_ptr().cast());
            (f.enable_array)(NORMAL_ARRAY);
            if !colors.is_empty() {
                (f.color_pointer)(4, FLOAT, 0, colors.as_ptr().cast());
                (f.enable_array)(COLOR_ARRAY);
            }
            (f.draw_arrays_raw)(TRIANGLES, 0, count);
            for array in [VERTEX_ARRAY, NORMAL_ARRAY, COLOR_ARRAY] {
                (f.disable_array)(array);
            }
            (f.vertex_pointer)(3, FLOAT, 0, null());
            (f.normal_pointer)(FLOAT, 0, null());
            (f.color_pointer)(4, FLOAT, 0, null());
        }
    }

    /// The colours of the framebuffer, bottom row first.
    pub(super) fn read_colors(&self, width: usize, height: usize) -> Vec<[f32; 4]> {
        let mut pixels = vec![[0f32; 4]; width * height];
        self.read(width, height, RGBA, pixels.as_flattened_mut());
        pixels
    }

    /// The depths of the framebuffer, bottom row first.
    pub(super) fn read_depths(&self, width: usize, height: usize) -> Vec<f32> {
        let mut pixels = vec![0f32; width * height];
        self.read(width, height, DEPTH_COMPONENT, &mut pixels);
        pixels
    }

    fn read(&self, width: usize, height: usize, format: u32, into: &mut [f32]) {
        let components = if format == RGBA { 4 } else { 1 };
        assert_eq!(into.len(), width * height * components);
        let (w, h) = (width as i32, height as i32);
        // SAFETY: the context is current, the pack state is GL's default, so GL writes width x height pixels of
        // `components` f32 without gaps (rows of f32 are aligned to 4), which is the length checked above.
        unsafe { (self.functions.read_pixels)(0, 0, w, h, format, FLOAT, into.as_mut_ptr().cast()) }
    }

    /// A new framebuffer.
    pub(super) fn new_framebuffer(&self) -> u32 {
        let mut name = 0;
        // SAFETY: the context is current; GL writes one name.
        unsafe { (self.functions.gen_framebuffers)(1, &raw mut name) };
        name
    }

    /// Deletes a framebuffer.
    pub(super) fn delete_framebuffer(&self, name: u32) {
        // SAFETY: the context is current; GL reads one name.
        unsafe { (self.functions.delete_framebuffers)(1, &raw const name) }
    }

    /// A new renderbuffer.
    pub(super) fn new_renderbuffer(&self) -> u32 {
        let mut name = 0;
        // SAFETY: the context is current; GL writes one name.
        unsafe { (self.functions.gen_renderbuffers)(1, &raw mut name) };
        name
    }

    /// Deletes a renderbuffer.
    pub(super) fn delete_renderbuffer(&self, name: u32) {
        // SAFETY: the context is current; GL reads one name.
        unsafe { (self.functions.delete_renderbuffers)(1, &raw const name) }
    }

    /// Sets a shader's text; whether it compiled, and the driver's remarks.
    pub(super) fn compile(&self, shader: u32, source: &str) -> Result<(), String> {
        let f = &self.functions;
        let (text, length) = (source.as_ptr().cast::<c_char>(), source.len() as i32);
        // SAFETY: the context is current; GL copies `length` bytes of one string.
        unsafe { (f.shader_source)(shader, 1, &raw const text, &raw const length) };
        self.compile_shader(shader);
        self.status(shader, COMPILE_STATUS, f.get_shader, f.get_shader_log)
    }

    /// Links a program; the driver's remarks where it fails.
    pub(super) fn link(&self, program: u32) -> Result<(), String> {
        self.link_program(program);
        let f = &self.functions;
        self.status(program, LINK_STATUS, f.get_program, f.get_program_log)
    }

    fn status(
        &self,
        name: u32,
        status: u32,
        get: unsafe extern "system" fn(u32, u32, *mut i32),
        get_log: unsafe extern "system" fn(u32, i32, *mut i32, *mut c_char),
    ) -> Result<(), String> {
        let (mut done, mut length, mut log) = (0, 0, [0u8; LOG]);
        // SAFETY: the context is current; GL writes one number each, and at most LOG bytes of text.
        unsafe {
            get(name, status, &raw mut done);
            get_log(name, LOG as i32, &raw mut length, log.as_mut_ptr().cast());
        }
        if done != 0 {
            return Ok(());
        }
        let length = (length.max(0) as usize).min(LOG);
        Err(String::from_utf8_lossy(&log[..length]).trim().to_owned())
    }

    /// Sets a uniform (array) of four-component vectors; names that the driver optimised away are passed over.
    pub(super) fn uniform(&self, program: u32, name: &str, values: &[[f32; 4]]) {
        let Ok(name) = CString::new(name) else { return };
        let count = i32::try_from(values.len()).unwrap_or(0);
        // SAFETY: the context is current; GL reads a string that ends in 0, then `count` vectors. Location -1 is ignored.
        unsafe {
            let location = (self.functions.get_uniform_location)(program, name.as_ptr());
            (self.functions.uniform_4fv)(location, count, values.as_flattened().as_ptr());
        }
    }
}

/// Vertices of separate triangles.
#[derive(Debug, Default)]
pub(super) struct Arrays {
    /// Positions.
    pub(super) positions: Vec<[f32; 3]>,
    /// Normals.
    pub(super) normals: Vec<[f32; 3]>,
    /// Colours; empty = the current colour.
    pub(super) colors: Vec<[f32; 4]>,
}

impl Arrays {
    /// Forgets the vertices, keeps the memory.
    pub(super) fn clear(&mut self) {
        self.positions.clear();
        self.normals.clear();
        self.colors.clear();
    }
}

macro_rules! names {
    ( $( $name:ident = $value:literal; )* ) => {
        $( #[doc = concat!("`GL_", stringify!($name), "`")] pub(super) const $name: u32 = $value; )*
    };
}

names! {
    TRIANGLES = 0x0004;
    POINTS = 0x0000;
    LESS = 0x0201;
    EQUAL = 0x0202;
    ONE = 1;
    SRC_ALPHA = 0x0302;
    ONE_MINUS_SRC_ALPHA = 0x0303;
    FRONT = 0x0404;
    FRONT_AND_BACK = 0x0408;
    BACK = 0x0405;
    CW = 0x0900;
    CCW = 0x0901;
    CULL_FACE = 0x0B44;
    LIGHTING = 0x0B50;
    LIGHT_MODEL_LOCAL_VIEWER = 0x0B51;
    LIGHT_MODEL_TWO_SIDE = 0x0B52;
    LIGHT_MODEL_AMBIENT = 0x0B53;
    COLOR_MATERIAL = 0x0B57;
    DEPTH_TEST = 0x0B71;
    NORMALIZE = 0x0BA1;
    DITHER = 0x0BD0;
    BLEND = 0x0BE2;
    MAX_LIGHTS = 0x0D31;
    MAX_VIEWPORT_DIMS = 0x0D3A;
    SUBPIXEL_BITS = 0x0D50;
    AMBIENT = 0x1200;
    DIFFUSE = 0x1201;
    SPECULAR = 0x1202;
    POSITION = 0x1203;
    SPOT_DIRECTION = 0x1204;
    SPOT_EXPONENT = 0x1205;
    SPOT_CUTOFF = 0x1206;
    CONSTANT_ATTENUATION = 0x1207;
    LINEAR_ATTENUATION = 0x1208;
    QUADRATIC_ATTENUATION = 0x1209;
    FLOAT = 0x1406;
    EMISSION = 0x1600;
    SHININESS = 0x1601;
    AMBIENT_AND_DIFFUSE = 0x1602;
    MODELVIEW = 0x1700;
    PROJECTION = 0x1701;
    DEPTH_COMPONENT = 0x1902;
    RGBA = 0x1908;
    FLAT = 0x1D00;
    SMOOTH = 0x1D01;
    VENDOR = 0x1F00;
    RENDERER = 0x1F01;
    VERSION = 0x1F02;
    EXTENSIONS = 0x1F03;
    LIGHT0 = 0x4000;
    RESCALE_NORMAL = 0x803A;
    VERTEX_ARRAY = 0x8074;
    NORMAL_ARRAY = 0x8075;
    COLOR_ARRAY = 0x8076;
    DEPTH_COMPONENT24 = 0x81A6;
    LIGHT_MODEL_COLOR_CONTROL = 0x81F8;
    SINGLE_COLOR = 0x81F9;
    SEPARATE_SPECULAR_COLOR = 0x81FA;
    COLOR_SUM = 0x8458;
    MAX_RENDERBUFFER_SIZE = 0x84E8;
    VERTEX_PROGRAM_TWO_SIDE = 0x8643;
    RGBA32F = 0x8814;
    CLAMP_VERTEX_COLOR = 0x891A;
    CLAMP_FRAGMENT_COLOR = 0x891B;
    CLAMP_READ_COLOR = 0x891C;
    FRAGMENT_SHADER = 0x8B30;
    VERTEX_SHADER = 0x8B31;
    MAX_FRAGMENT_UNIFORM_COMPONENTS = 0x8B49;
    MAX_VERTEX_UNIFORM_COMPONENTS = 0x8B4A;
    COMPILE_STATUS = 0x8B81;
    LINK_STATUS = 0x8B82;
    SHADING_LANGUAGE_VERSION = 0x8B8C;
    DEPTH_COMPONENT32F = 0x8CAC;
    FRAMEBUFFER_COMPLETE = 0x8CD5;
    COLOR_ATTACHMENT0 = 0x8CE0;
    DEPTH_ATTACHMENT = 0x8D00;
    FRAMEBUFFER = 0x8D40;
    RENDERBUFFER = 0x8D41;
    COLOR_BUFFER_BIT = 0x4000;
    DEPTH_BUFFER_BIT = 0x0100;
}
