//! Broken scene files: what is said, and where.

use super::{failure, load_files, load_text};

/// Sections before a legal object: text, "line:column message", help.
const SECTIONS: &[(&str, &str, &str)] = &[
    (
        "[camera]\nfov = 3\n",
        "2:1 camera has no key `fov`",
        "did you mean `fovy`?",
    ),
    (
        "[light.a]\nposition = [1, 2]\n",
        "2:12 position: expected three or four numbers, [x, y, z] or [x, y, z, w], found a list of 2",
        "",
    ),
    (
        "[light.a]\nposition = [1, 2, nan]\n",
        "2:19 position: expected a finite number, found NaN",
        "",
    ),
    (
        "[light.a]\nposition = [1, -inf, 0]\n",
        "2:16 position: expected a finite number, found -inf",
        "",
    ),
    (
        "[light.a]\nposition = [1, 1e400, 0]\n",
        "2:16 position: expected a finite number, found inf",
        "",
    ),
    (
        "[light.a]\nposition = [1, 1e39, 0]\n",
        "2:16 position: expected a number of magnitude 3.4e38 or less (single precision), found 1e39",
        "",
    ),
    (
        "[light.a]\nposition = [0, 0, 1]\ndirection = [0, 0, 1]\n",
        "3:13 direction: a light with a position has no direction",
        "remove one; the axis of a spot is spot_direction",
    ),
    (
        "[light.a]\ndiffuse = 1\n",
        "1:8 light.a: expected a position, or a direction for a directional light",
        "add position = [x, y, z] or direction = [x, y, z]",
    ),
    (
        "[light.a]\ndirection = [0, 0, 0]\n",
        "2:13 direction: expected a direction, found the zero vector",
        "",
    ),
    (
        "[light.a]\nposition = [0, 0, 1]\nspot_cutoff = 181\n",
        "3:15 spot_cutoff: expected a number from 0 to 180, found 181",
        "",
    ),
    (
        "[light.a]\nposition = [0, 0, 1]\nspace = \"eyes\"\n",
        "3:9 space: expected one of `world` and `eye`, found the string \"eyes\"",
        "did you mean `eye`?",
    ),
    (
        "[light.a]\nposition = [0, 0, 1]\nenabled = 1\n",
        "3:11 enabled: expected true or false, found 1",
        "",
    ),
    (
        "[light]\nposition = [0, 0, 1]\n",
        "2:1 light.position: expected a table, found a list of 3",
        "write [light.NAME], with a name of your own",
    ),
    (
        "[material.red]\nshinyness = 3\n",
        "2:1 material.red has no key `shinyness`",
        "did you mean `shininess`?",
    ),
    (
        "[material.red]\nshininess = \"3\"\n",
        "2:13 shininess: expected a number, 0 or more, found the string \"3\"",
        "",
    ),
    (
        "[material.red]\nshininess = -1\n",
        "2:13 shininess: expected a number, 0 or more, found -1",
        "",
    ),
    (
        "[material.red]\ncolor = [1, 0]\n",
        "2:9 color: expected a colour: a number (grey) or [red, green, blue], found a list of 2",
        "",
    ),
    (
        "[material.red]\ncolor = \"red\"\n",
        "2:9 color: expected a colour: a number (grey) or [red, green, blue], found the string \"red\"",
        "",
    ),
    (
        "[material.red]\ncolor = 1\ndiffuse = 0.5\n",
        "3:11 diffuse: `color` sets ambient and diffuse together",
        "remove `color` or `diffuse`",
    ),
    (
        "[material.red]\nreflection = \"KS\"\n",
        "2:14 reflection: expected a number, [red, green, blue] or \"K_S\", found the string \"KS\"",
        "",
    ),
    (
        "[material.red]\nior = 0\n",
        "2:7 ior: expected a number above 0, found 0",
        "",
    ),
    (
        "[material.red]\ntexture = \"a.png\"\n",
        "2:11 `texture` is not supported: textures are not in this version",
        "",
    ),
    (
        "[material.red]\nback = 3\n",
        "2:8 material.red.back: expected a table, found 3",
        "",
    ),
    (
        "[material.red]\nback = { ior = 3 }\n",
        "2:10 material.red.back has no key `ior`",
        "there are `color`, `emission`, `ambient`, `diffuse`, `specular` and `shininess`",
    ),
    (
        "[material.red]\ncolor = 1\ncolor = 2\n",
        "3:1 color stands twice",
        "the first is in line 2; remove one of them",
    ),
    (
        "[material.red]\n[material.red]\n",
        "2:11 material.red stands twice",
        "the first is in line 1; give one of them another name",
    ),
    (
        "[image]\nwidth = 0\n",
        "2:9 width: expected a whole number from 1 to 16384, found 0",
        "",
    ),
    (
        "[image]\nwidth = 640.5\n",
        "2:9 width: expected a whole number from 1 to 16384, found 640.5",
        "",
    ),
    (
        "[image]\nheight = 99999999999999999999\n",
        "2:10 height: expected a whole number from 1 to 16384, found 99999999999999999999",
        "",
    ),
    (
        "[image]\nwidth = 16384\nheight = 16384\n",
        "1:2 image: 16384 x 16384 is 268435456 pixels, more than 134217728",
        "",
    ),
    (
        "[image]\nsamples = 4097\n",
        "2:11 samples: expected a whole number from 1 to 4096, found 4097",
        "",
    ),
    (
        "[image]\npattern = \"gird\"\n",
        "2:11 pattern: expected one of `grid` and `jitter`, found the string \"gird\"",
        "did you mean `grid`?",
    ),
    (
        "[image]\nbackground = 1979-05-27\n",
        "2:14 background: expected a colour: a number (grey) or [red, green, blue], found a date",
        "",
    ),
    (
        "[camera]\nfovy = 180\n",
        "2:8 fovy: expected a number between 0 and 180, both excluded, found 180",
        "",
    ),
    (
        "[camera]\nnear = 0\n",
        "2:8 near: expected a number above 0, found 0",
        "",
    ),
    (
        "[camera]\nnear = 2\nfar = 2\n",
        "3:7 far: expected more than near = 2, found 2",
        "",
    ),
    (
        "[camera]\neye = [1, 2, 3]\ntarget = [1, 2, 3]\n",
        "3:10 target: the same point as eye, [1, 2, 3]",
        "",
    ),
    (
        "[camera]\neye = [0, 5, 0]\ntarget = [0, 0, 0]\n",
        "1:2 camera: up: [0, 1, 0] is parallel to the view from eye to target",
        "",
    ),
    (
        "[camera]\neye = [0, 5, 0]\ntarget = [0, 0, 0]\nup = [0, -2, 0]\n",
        "4:6 up: [0, -2, 0] is parallel to the view from eye to target",
        "",
    ),
    (
        "[camera]\neye = [0, 5, 0]\nup = [0, 0, 0]\n",
        "3:6 up: expected a direction, found the zero vector",
        "",
    ),
    (
        "[camera]\nfovy = 45\northographic = 3\n",
        "2:8 fovy: a parallel view has no angle",
        "remove fovy or orthographic",
    ),
    (
        "[camera]\northographic = -3\n",
        "2:16 orthographic: expected a number above 0, found -3",
        "",
    ),
    (
        "[raster]\ntransparency = \"blended\"\n",
        "2:16 transparency: expected one of `opaque` and `blend`, found the string \"blended\"",
        "did you mean `blend`?",
    ),
    (
        "[raster]\nsnap = 9\n",
        "2:8 snap: expected 8, 12 or \"exact\", found 9",
        "",
    ),
    (
        "[raster]\ndepth_range = [0, 2]\n",
        "2:15 depth_range: expected [near, far], each from 0 to 1, found [0, 2]",
        "",
    ),
    (
        "[raster]\nshading = \"pong\"\n",
        "2:11 shading: expected one of `flat`, `gouraud`, `phong`, `per-vertex` and `per-pixel`, found the string \"pong\"",
        "did you mean `phong`?",
    ),
    (
        "[light_model]\ncolor_material = \"diffuse\"\n",
        "2:18 color_material: expected true, false or a table { face, mode }, found the string \"diffuse\"",
        "",
    ),
    (
        "[light_model]\ncolor_material = { mode = \"difuse\" }\n",
        "2:27 mode: expected one of `emission`, `ambient`, `diffuse`, `specular` and `ambient_and_diffuse`, found the string \"difuse\"",
        "did you mean `diffuse`?",
    ),
    (
        "[object.a]\npositions = [0, 0, 0, 1, 0, 0, 0, 1, 0]\ncolors = [[1, 0, 0]]\n",
        "3:10 colors: expected one for each of 3 positions, found 1",
        "",
    ),
    (
        "[trace]\ndepth = -1\n",
        "2:9 depth: expected a whole number from 0 to 1048576, found -1",
        "",
    ),
    (
        "[trace]\nshadows = \"opaque\"\n",
        "2:1 trace has no key `shadows`",
        "did you mean `shadow`?",
    ),
    (
        "[lights.a]\nposition = [0, 0, 1]\n",
        "1:2 there is no section `lights`",
        "did you mean `light`?",
    ),
    (
        "convention = \"lectures\"\n",
        "1:14 convention: expected one of `opengl` and `lecture`, found the string \"lectures\"",
        "did you mean `lecture`?",
    ),
    (
        "include = \"a.toml\"\n",
        "1:11 include: expected a list of file names, [\"materials.toml\"], found the string \"a.toml\"",
        "",
    ),
    ("camera = 3\n", "1:10 camera: expected a table, found 3", ""),
];

#[test]
fn a_key_outside_of_its_section_is_sent_home() {
    check(
        "fovy = 30\n",
        "1:1 `fovy` stands outside of any section",
        "it belongs into [camera]",
    );
    check(
        "conventoin = \"lecture\"\n",
        "1:1 `conventoin` stands outside of any section",
        "did you mean `convention`?",
    );
}

#[test]
fn instances_repeat_what_stands_further_up() {
    let forms = "a `shape`, a `mesh` file, inline `positions`, or an `instance` of another object";
    for (text, message, help) in [
        (
            "[object.a]\ninstance = \"b\"\n[object.b]\nshape = \"box\"\n",
            "2:12 instance: `b` stands further down",
            "move [object.b] up, before its instances".to_owned(),
        ),
        (
            "[object.a]\ninstance = \"a\"\n",
            "2:12 instance: `a` cannot repeat itself",
            format!("say what it is: {forms}"),
        ),
        (
            "[object.ball]\nshape = \"sphere\"\n[object.a]\ninstance = \"bal\"\n",
            "4:12 instance: there is no object called `bal`",
            "did you mean `ball`?".to_owned(),
        ),
        (
            "[object.a]\nshape = \"box\"\n[object.b]\ninstance = 3\n",
            "4:12 instance: expected the name of an object, found 3",
            String::new(),
        ),
        (
            "[object.a]\nshape = \"box\"\ntransform = [{ scale = 1e-60 }]\n\
             [object.b]\ninstance = \"a\"\ntransform = [{ scale = 1e-60 }]\n",
            "5:12 instance: its transform and that of a together leave the number range",
            String::new(),
        ),
    ] {
        check(text, message, &help);
    }
}

/// Slips of whoever writes TOML by hand: text, "line:column message", help.
const SLIPS: &[(&str, &str, &str)] = &[
    (
        "[image]\nwidth = 64 64\n",
        "2:9 a comma is missing between 64 and 64",
        "",
    ),
    (
        "[camera]\neye = [0.3 2.1, 7.2]\n",
        "2:8 a comma is missing between 0.3 and 2.1",
        "",
    ),
    (
        "[camera]\neye = [0.3; 2.1; 7.2]\n",
        "2:8 the numbers of a list are separated by commas",
        "",
    ),
    (
        "[camera]\neye = (1, 2, 3)\n",
        "2:9 a list stands in square brackets",
        "write [1, 2, 3]",
    ),
    (
        "[camera]\neye = [1, 2,\n  3\nfovy = 3\n",
        "4:1 the list that begins in line 2 is not closed",
        "put `]` at its end",
    ),
    (
        "[camera]\nfovy = \n",
        "2:8 a value is missing behind `=`",
        "",
    ),
    (
        "[camera]\nfovy = 30,5\n",
        "2:10 a decimal point is a dot",
        "write 0.5 for 0,5, and [1, 2, 3] for a list",
    ),
    (
        "[camera]\nfovy = 30;\n",
        "2:8 nothing follows a value on its line",
        "remove the `;`",
    ),
    (
        "[camera]\nfovy = 30.\n",
        "2:11 a number has digits on both sides of its point",
        "write 1.0 for 1., and 0.5 for .5",
    ),
    (
        "[camera]\nfovy: 30\n",
        "2:7 `=` stands between a key and its value, not `:`",
        "",
    ),
    (
        "[camera]\nfovy 30\n",
        "2:6 `=` is missing between the key and its value",
        "",
    ),
    ("// a comment\n", "1:4 a comment begins with `#`", ""),
    (
        "[material.mirror ball]\n",
        "1:17 a name with a space stands in quotes",
        "write [material.\"mirror ball\"]",
    ),
    (
        "[object.a]\nmaterial = red\n",
        "2:12 text stands in quotes",
        "write \"red\", if it is meant as text",
    ),
    (
        "[object.a]\nmaterial = \"red\n",
        "2:16 the string is not closed: expected `\"`",
        "",
    ),
    (
        "[object.a]\nmaterial = 'red\n",
        "2:16 the string is not closed: expected `'`",
        "",
    ),
    (
        "[[light]]\ndiffuse = 1\n",
        "1:1 light: expected a table, found a list of 1",
        "write [light.NAME], with a name of your own",
    ),
    (
        "{ \"camera\": 1 }\n",
        "1:1 holds JSON, not a TOML scene",
        "`rastray scenes whitted` prints one to start from",
    ),
];

#[test]
fn slips_of_the_hand_are_called_by_their_names() {
    for (text, message, help) in SLIPS {
        check(text, message, help);
    }
}

/// Whole files: text, "line:column message", help.
const FILES: &[(&str, &str, &str)] = &[
    ("[material.red\n", "1:14 unclosed table, expected `]`", ""),
    (
        "[object.a]\nmaterial = \"red\"\n",
        "1:9 object.a: expected a `shape`, a `mesh` file, inline `positions`, or an `instance` of another object",
        "",
    ),
    (
        "[object.a]\nshape = \"sphere\"\nmesh = \"a.obj\"\n",
        "1:9 object.a: expected one of a `shape`, a `mesh` file, inline `positions`, or an `instance` of another object, found `shape` and `mesh`",
        "",
    ),
    (
        "[object.a]\nshape = \"sphare\"\n",
        "2:9 shape: expected one of `sphere`, `plane`, `quad`, `disk`, `box`, `cylinder`, `cone`, `torus`, `revolution`, `bezier`, `teapot` and `checkered floor`, found \"sphare\"",
        "did you mean `sphere`?",
    ),
    (
        "[object.a]\nshape = 3\n",
        "2:9 shape: expected one of `sphere`, `plane`, `quad`, `disk`, `box`, `cylinder`, `cone`, `torus`, `revolution`, `bezier`, `teapot` and `checkered floor`, found 3",
        "",
    ),
    (
        "[object.a]\nshape = \"sphere\"\nmaterial = \"rde\"\n[material.red]\n",
        "3:12 there is no material called `rde`",
        "did you mean `red`?",
    ),
    (
        "[object.a]\nshape = \"sphere\"\nmaterial = \"red\"\n",
        "3:12 there is no material called `red`",
        "add [material.red]",
    ),
    (
        "[object.a]\nshape = \"sphere\"\nradius = 0\n",
        "3:10 radius: expected a number above 0, found 0",
        "",
    ),
    (
        "[object.a]\nshape = \"sphere\"\nsize = 2\n",
        "3:1 object.a has no key `size`",
        "there are `shape`, `mesh`, `instance`, `material`, `materials`, `transform`, `center`, `radius` and `tessellation`",
    ),
    (
        "[object.a]\nshape = \"sphere\"\ntessellation = 2\n",
        "3:16 tessellation: expected a whole number from 3 to 4096, found 2",
        "",
    ),
    (
        "[object.a]\nshape = \"cone\"\ntessellation = 2\n",
        "3:16 tessellation: expected a whole number from 3 to 4096, found 2",
        "",
    ),
    (
        "[object.a]\nshape = \"cilinder\"\n",
        "2:9 shape: expected one of `sphere`, `plane`, `quad`, `disk`, `box`, `cylinder`, `cone`, `torus`, `revolution`, `bezier`, `teapot` and `checkered floor`, found \"cilinder\"",
        "did you mean `cylinder`?",
    ),
    (
        "[object.a]\nshape = \"cylinder\"\nbase = [0, 2, 0]\ntop = [0, 2, 0]\n",
        "4:7 top: expected `base` and `top` to be different points",
        "",
    ),
    (
        "[object.a]\nshape = \"cone\"\nbase = [0, 1, 0]\n",
        "3:8 base: expected `base` and `apex` to be different points",
        "",
    ),
    (
        "[object.a]\nshape = \"cone\"\ncaps = false\n",
        "3:1 object.a has no key `caps`",
        "did you mean `cap`?",
    ),
    (
        "[object.a]\nshape = \"torus\"\nmajor_radius = 0.2\n",
        "3:16 major_radius: expected minor_radius below major_radius, found 0.25 and 0.2",
        "",
    ),
    (
        "[object.a]\nshape = \"torus\"\naxis = [0, 0, 0]\n",
        "3:8 axis: expected a direction, found the zero vector",
        "",
    ),
    (
        "[object.a]\nshape = \"revolution\"\n",
        "1:9 object.a: expected a `profile`: points [radius, height]",
        "",
    ),
    (
        "[object.a]\nshape = \"revolution\"\nprofile = [[1, 0]]\n",
        "3:11 profile: expected 2 to 1024 points, found 1",
        "",
    ),
    (
        "[object.a]\nshape = \"revolution\"\nprofile = [1, 0, 1, 2]\n",
        "3:12 profile: expected a point [radius, height], found 1",
        "",
    ),
    (
        "[object.a]\nshape = \"revolution\"\nprofile = [[1, 0], [2, 1], [-1, 2]]\n",
        "3:28 profile: point 3: expected a radius of 0 or more, found -1.0",
        "",
    ),
    (
        "[object.a]\nshape = \"revolution\"\nprofile = [[1, 0], [2, inf]]\n",
        "3:24 profile: expected a finite number, found inf",
        "",
    ),
    (
        "[object.a]\nshape = \"revolution\"\nprofile = [[1, 0], [1, 0], [2, 0]]\n",
        "3:20 profile: point 2: the same point twice in a row",
        "",
    ),
    (
        "[object.a]\nshape = \"revolution\"\nprofile = [[0, 0], [0, 1]]\n",
        "3:11 profile: all its points are on the axis",
        "",
    ),
    (
        "[object.a]\nshape = \"revolution\"\ncurve = \"bezier\"\nprofile = [[1, 0], [1, 1], [1, 2], [1, 3], [1, 4]]\n",
        "4:11 profile: expected 3 n + 1 points for n Bezier segments (4, 7, 10 ...), found 5",
        "",
    ),
    (
        "[object.a]\nshape = \"revolution\"\ncurve = \"smoth\"\nprofile = [[1, 0], [1, 1]]\n",
        "3:9 curve: expected one of `polyline`, `smooth` and `bezier`, found the string \"smoth\"",
        "did you mean `smooth`?",
    ),
    (
        "[object.a]\nshape = \"revolution\"\nprofil = [[1, 0], [1, 1]]\n",
        "3:1 object.a has no key `profil`",
        "did you mean `profile`?",
    ),
    (
        "[object.a]\nshape = \"teapot\"\nradius = 1\nheight = 1\n",
        "4:10 height: a teapot has `radius` or `height`, not both",
        "",
    ),
    (
        "[object.a]\nshape = \"teapot\"\nheight = 0\n",
        "3:10 height: expected a number above 0, found 0",
        "",
    ),
    (
        "[object.a]\nshape = \"teapot\"\ncenter = [0, 0, 0]\n",
        "3:1 object.a has no key `center`",
        "there are `shape`, `mesh`, `instance`, `material`, `materials`, `transform`, `base`, `radius`, `height` and `tessellation`",
    ),
    (
        "[object.a]\nshape = \"teapot\"\ntessellation = 2\n",
        "3:16 tessellation: expected a whole number from 3 to 4096, found 2",
        "",
    ),
    (
        "[object.a]\nshape = \"bezier\"\n",
        "1:9 object.a: expected `patches`, with `points` or as the name of a file",
        "",
    ),
    (
        "[object.a]\nshape = \"bezier\"\npatches = [[0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]]\n",
        "3:11 patches: expected `points` for its numbers",
        "",
    ),
    (
        "[object.a]\nshape = \"bezier\"\npoints = []\npatches = [[0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]]\n",
        "3:10 points: expected from 1 to 1048576 points, found 0",
        "",
    ),
    (
        "[object.a]\nshape = \"bezier\"\npoints = [[0, 0, 0]]\npatches = []\n",
        "4:11 patches: expected from 1 to 65536 patches, found 0",
        "",
    ),
    (
        "[object.a]\nshape = \"bezier\"\npoints = [[0, 0, 0]]\npatches = [[0, 0, 0]]\n",
        "4:12 patches: expected 16 point numbers, found 3",
        "",
    ),
    (
        "[object.a]\nshape = \"bezier\"\npoints = [[0, 0, 0], [1, 0, 0]]\npatches = [[0, 1, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]]\n",
        "4:19 patches: expected a whole number from 0 to 1, found 2",
        "",
    ),
    (
        "[object.a]\nshape = \"bezier\"\npoints = [[0, 0, nan]]\npatches = [[0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]]\n",
        "3:18 points: expected a finite number, found NaN",
        "",
    ),
    (
        "[object.a]\nshape = \"bezier\"\npatches = 3\n",
        "3:11 patches: expected a list of patches of 16 point numbers each, or the name of a file, found 3",
        "",
    ),
    (
        "[object.a]\nshape = \"bezier\"\npatches = \"pot.bpt\"\n",
        "3:11 patches: there is no file pot.bpt",
        "a file of patches is looked for beside the scene file",
    ),
    (
        "[object.a]\nshape = \"bezier\"\npoints = []\npatches = \"pot.bpt\"\n",
        "3:10 points: does not go with a file of patches, which has its own",
        "",
    ),
    (
        "[object.a]\nshape = \"disk\"\nradius = -1\n",
        "3:10 radius: expected a number above 0, found -1",
        "",
    ),
    (
        "[object.a]\nshape = \"sphere\"\ntessellation = 5000\n",
        "3:16 tessellation: expected a whole number from 1 to 4096, found 5000",
        "",
    ),
    (
        "[object.a]\nshape = \"sphere\"\nmaterials = []\n",
        "3:13 materials: expected at least one name",
        "",
    ),
    (
        "[object.a]\nshape = \"plane\"\nnormal = [0, 0, 0]\n",
        "3:10 normal: expected a direction, found the zero vector",
        "",
    ),
    (
        "[object.a]\nshape = \"plane\"\nsize = [1, -1]\n",
        "3:12 size: expected a number above 0, found -1",
        "",
    ),
    (
        "[object.a]\nshape = \"quad\"\ncorner = [0, 0, 0]\nedge_u = [1, 0, 0]\n",
        "1:9 object.a: expected `points`, or `corner`, `edge_u` and `edge_v`; `edge_v` is missing",
        "",
    ),
    (
        "[object.a]\nshape = \"quad\"\npoints = [[0, 0, 0], [1, 0, 0], [1, 1, 0]]\n",
        "3:10 points: expected four corners, found 3",
        "",
    ),
    (
        "[object.a]\nshape = \"box\"\nmin = [0, 0, 0]\nmax = [1, 0, 1]\n",
        "4:7 max: expected each coordinate of `min` below that of `max`",
        "",
    ),
    (
        "[object.a]\nshape = \"box\"\nmin = [0, 0, 0]\n",
        "1:9 object.a: `min` and `max` go together",
        "",
    ),
    (
        "[object.a]\nshape = \"checkered floor\"\ntiles = [4, 0]\n",
        "3:13 tiles: expected a whole number from 1 to 4096, found 0",
        "",
    ),
    (
        "[object.a]\nshape = \"checkered floor\"\ntiles = 4096\ntessellation = 64\n",
        "1:9 object.a: the scene's shapes ask for 137438953472 triangles, more than 16777216",
        "lower tessellation or tiles",
    ),
    (
        "[object.a]\nmesh = \"nowhere.obj\"\n",
        "2:8 mesh: there is no file nowhere.obj",
        "a mesh file is looked for beside the scene file",
    ),
    (
        "[object.a]\nmesh = \"ball.ply\"\n",
        "2:8 mesh: expected an OBJ file, found \"ball.ply\"",
        "",
    ),
    (
        "[object.a]\npositions = [[0, 0, 0], [1, 0], [0, 1, 0]]\n",
        "2:25 positions: expected 3 numbers, found a list of 2",
        "",
    ),
    (
        "[object.a]\npositions = [0, 0, 0, 1]\n",
        "2:13 positions: expected 3 numbers each, found 4 numbers",
        "",
    ),
    (
        "[object.a]\npositions = [0, 0, 0, 1, 0, 0]\n",
        "2:13 positions: without `indices` every three make a triangle; 2 is no multiple of 3",
        "",
    ),
    (
        "[object.a]\npositions = [0, 0, 0, 1, 0, 0, 0, 1, 0]\nindices = [0, 1, 3]\n",
        "3:18 indices: expected a whole number from 0 to 2, found 3",
        "",
    ),
    (
        "[object.a]\npositions = [0, 0, 0, 1, 0, 0, 0, 1, 0]\nindices = [[0, 1]]\n",
        "3:12 indices: expected a face of three or more vertex numbers, found a list of 2",
        "",
    ),
    (
        "[object.a]\npositions = [0, 0, 0, 1, 0, 0, 0, 1, 0]\nnormals = [0, 0, 1]\n",
        "3:11 normals: expected one for each of 3 positions, found 1",
        "",
    ),
    (
        "[object.a]\npositions = []\n",
        "1:9 object.a: the mesh has no triangle",
        "",
    ),
    (
        "[object.a]\nshape = \"sphere\"\ntransform = [{ scale = [1, 0, 1] }]\n",
        "3:24 scale: expected factors other than 0",
        "",
    ),
    (
        "[object.a]\nshape = \"sphere\"\ntransform = [{ scale = 2, translate = [1, 0, 0] }]\n",
        "3:14 object.a.transform[0]: expected exactly one of `translate`, `rotate`, `scale` or `matrix`, found 2 keys",
        "",
    ),
    (
        "[object.a]\nshape = \"sphere\"\ntransform = [{ rotate = { axis = [0, 1, 0] } }]\n",
        "3:25 object.a.transform[0].rotate: expected `degrees`",
        "",
    ),
    (
        "[object.a]\nshape = \"sphere\"\ntransform = { scale = 2 }\n",
        "3:13 transform: expected a list of steps such as [{ translate = [0, 1, 0] }], found a table",
        "",
    ),
    (
        "[object.a]\nshape = \"sphere\"\ntransform = [{ matrix = [1, 2, 3] }]\n",
        "3:25 matrix: expected 16 numbers, row by row, found a list of 3",
        "",
    ),
    (
        "[object.a]\nshape = \"sphere\"\ntransform = [{ matrix = [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,1,0] }]\n",
        "3:25 matrix: expected the last row 0, 0, 0, 1 (no projection)",
        "numbers stand row by row; the translation is the last of each row",
    ),
    (
        "[object.a]\nshape = \"sphere\"\ntransform = [{ matrix = [1,0,0,0, 1,0,0,0, 0,0,1,0, 0,0,0,1] }]\n",
        "3:13 transform: the steps together flatten the object",
        "",
    ),
    ("", "is empty", ""),
    (
        "# nothing but a comment\n",
        "the scene has no object",
        "add one, for example [object.ball] with shape = \"sphere\"",
    ),
    (
        "# an OBJ\nv 0 0 0\nv 1 0 0\n",
        "holds an OBJ mesh, not a TOML scene",
        "give it the extension .obj",
    ),
];

fn check(text: &str, message: &str, help: &str) {
    let found = failure(load_text("a.toml", text, &[]));
    assert_eq!(found, (message.to_owned(), help.to_owned()), "{text}");
}

#[test]
fn broken_sections_say_what_and_where() {
    for (text, message, help) in SECTIONS {
        let text = format!("{text}[object.ball]\nshape = \"sphere\"\n");
        check(&text, message, help);
        // The same with the line ends of another system, and further down in the file.
        let moved = format!("\u{feff}{}", text.replace('\n', "\r\n"));
        check(&moved, message, help);
    }
}

#[test]
fn broken_files_say_what_and_where() {
    for (text, message, help) in FILES {
        check(text, message, help);
    }
}

#[test]
fn what_is_no_scene_is_called_by_its_name() {
    let cases: &[(&[u8], &str)] = &[
        (b"  \n\t\n", "is empty"),
        (
            b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR",
            "is a PNG picture, not a scene",
        ),
        (
            b"\xff\xd8\xff\xe0\0\x10JFIF",
            "is a JPEG picture, not a scene",
        ),
        (b"a = 1\0\0", "is a binary file, not a scene"),
        (b"\xff\xfea\0", "is UTF-16 text; save it as UTF-8"),
        (b"# ok\n# gr\xfcn\n", "2:5 byte 0xfc is not UTF-8"),
    ];
    for (bytes, expected) in cases {
        let (message, _) = failure(load_text("a.toml", bytes, &[]));
        assert_eq!(&message, expected);
    }
    for file in ["a.obj", "a.toml"] {
        let (message, _) = failure(load_text(file, cases[1].0, &[]));
        assert_eq!(message, cases[1].1);
    }
    let (message, help) = failure(load_text("a.nff", "b 0 0 0", &[]));
    assert_eq!(message, "files of type .nff are not imported");
    assert_eq!(help, "rastray reads .toml and .scn scenes and .obj meshes");
    let folder = tempfile::tempdir().unwrap();
    let (message, _) = failure(super::load_with(folder.path(), &[]));
    assert_eq!(message, "is a folder, not a scene");
}

#[test]
fn errors_inside_a_mesh_file_name_the_mesh_file() {
    let scene = b"[object.a]\nmesh = \"a b.obj\"\n";
    let mesh = b"v 0 0 0\nv 1 0 0\nv 0 1 zero\nf 1 2 3\n";
    let files: [(&str, &[u8]); 2] = [("a.toml", scene), ("a b.obj", mesh)];
    let error = load_files(&files, &[]).err().unwrap();
    assert!(error.place().unwrap().file.ends_with("a b.obj"));
    assert!(
        error
            .to_string()
            .ends_with("a b.obj:3:7: expected a number, found `zero`")
    );
}

/// OBJ text, "line:column message".
const MESHES: &[(&str, &str)] = &[
    ("v 0 0\nf 1 1 1\n", "1:1 `v` needs 3 numbers, found 2"),
    ("v 0 0 nan\n", "1:7 expected a finite number, found `nan`"),
    (
        "v 0 0 1e999\n",
        "1:7 expected a finite number, found `1e999`",
    ),
    ("v 0,5 0 0\n", "1:3 expected a number, found `0,5`"),
    (
        "v 0 0 0\nf 1 2\n",
        "2:1 a face needs 3 corners or more, found 2",
    ),
    ("v 0 0 0\nf 1 1 2\n", "2:7 vertex 2: there are only 1"),
    ("v 0 0 0\nf 1 1 0\n", "2:7 vertex 0: indices count from 1"),
    (
        "v 0 0 0\nf -1 -1 -2\n",
        "2:9 vertex -2: there are only 1 so far",
    ),
    (
        "v 0 0 0\nf 1 1 1/1\n",
        "2:7 texture coordinate 1: there are only 0",
    ),
    (
        "v 0 0 0\nf 1 1 \\\n  1//7\n",
        "3:3 normal 7: there are only 0",
    ),
    (
        "v 0 0 0\nf 1 1 1/a\n",
        "2:7 expected a corner v, v/vt, v//vn or v/vt/vn, found `1/a`",
    ),
    (
        "v 0 0 0\nf 1 1 99999999999\n",
        "2:7 vertex 99999999999 is out of range",
    ),
    (
        "v 0 0 0\ns red\nf 1 1 1\n",
        "2:3 expected a smoothing group or `off`, found `red`",
    ),
    (
        "v 0 0 0\nvn 1 0\nf 1//1 1 1\n",
        "2:1 `vn` needs 3 numbers, found 2",
    ),
    ("v 0 0 0\n", "the mesh has no face"),
    ("# empty\n", "the mesh has no face"),
    (
        "[camera]\neye = [0, 0, 1]\n",
        "1:1 expected an OBJ statement (v, vt, vn, f, ...), found `[camera]`",
    ),
];

#[test]
fn broken_meshes_say_what_and_where() {
    for (text, expected) in MESHES {
        let (message, _) = failure(load_text("a.obj", text, &[]));
        assert_eq!(&message, expected, "{text}");
    }
}

/// MTL text, "line:column message".
const LIBRARIES: &[(&str, &str)] = &[
    ("newmtl\n", "1:1 `newmtl` needs a name"),
    (
        "newmtl a\nKd 1 0\n",
        "2:1 `Kd` needs 1 or 3 numbers, found 2",
    ),
    ("newmtl a\nKd\n", "2:1 `Kd` needs 1 or 3 numbers, found 0"),
    (
        "newmtl a\nKd 1 0 inf\n",
        "2:8 expected a finite number, found `inf`",
    ),
    ("newmtl a\nNs high\n", "2:4 expected a number, found `high`"),
    ("newmtl a\nNs -3\n", "2:4 expected Ns 0 or more, found -3"),
    ("newmtl a\nNi\n", "2:1 `Ni` needs a number"),
    ("newmtl a\nillum\n", "2:1 `illum` needs a number"),
    (
        "newmtl a\nKs spectral a.rfl\n",
        "2:1 `Ks spectral` is not supported: write red, green and blue",
    ),
];

#[test]
fn broken_libraries_say_what_and_where() {
    let mesh = b"mtllib a.mtl\nv 0 0 0\nusemtl a\nf 1 1 1\n";
    for (text, expected) in LIBRARIES {
        let files: [(&str, &[u8]); 2] = [("a.obj", mesh), ("a.mtl", text.as_bytes())];
        let (message, _) = failure(load_files(&files, &[]));
        assert_eq!(&message, expected, "{text}");
    }
}
