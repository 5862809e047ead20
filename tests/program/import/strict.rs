//! `--strict-gl`: what real OpenGL refuses is an error, whatever file it stands in; the rest loads as ever.

use rastray::import::{LoadOptions, load};

use super::failure;

fn strict(files: &[(&str, &str)]) -> Result<(), (String, String)> {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let path = folder.path().join(files[0].0);
    let load_with = |strict_gl: bool| {
        let options = LoadOptions {
            strict_gl,
            ..LoadOptions::default()
        };
        load(path.to_str().unwrap(), &options)
    };
    load_with(false).expect("legal without the flag");
    match load_with(true) {
        Ok(_) => Ok(()),
        Err(error) => Err(failure(Err(Box::new(error)))),
    }
}

const HELP: &str = "bring it into that range, or leave out --strict-gl";

#[test]
fn values_beyond_gls_ranges_are_refused_at_their_place() {
    let ball = "[object.ball]\nshape = \"sphere\"\nmaterial = \"m\"\n";
    for (text, message) in [
        (
            "[material.m]\nshininess = 129\n",
            "2:13 material.m: GL would refuse shininess 129 (0 to 128)",
        ),
        (
            "[material.m]\nback = { shininess = 300 }\n",
            "2:22 material.m: GL would refuse shininess 300 (0 to 128)",
        ),
        (
            "[material.m]\n[light.a]\nposition = [0, 0, 1]\nspot_cutoff = 100\nspot_exponent = 200\n",
            "5:17 light.a: GL would refuse spot_exponent 200 (0 to 128) (and 1 more)",
        ),
        (
            "[material.m]\n[light.a]\nposition = [0, 0, 1]\nattenuation = [1, -1, 0]\n",
            "4:15 light.a: GL would refuse attenuation -1 (0 or more)",
        ),
    ] {
        let found = strict(&[("a.toml", &format!("{text}{ball}"))]).expect_err(text);
        assert_eq!(found, (message.to_owned(), HELP.to_owned()));
    }
}

#[test]
fn other_files_are_held_to_the_same_ranges() {
    let obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl shiny\nf 1 2 3\n";
    let mtl = "newmtl shiny\nillum 2\nKs 1 1 1\nNs 900\n";
    let (message, help) = strict(&[("a.obj", obj), ("a.mtl", mtl)]).expect_err("Ns 900");
    assert!(
        message.ends_with("GL would refuse shininess 900 (0 to 128)"),
        "{message}"
    );
    assert_eq!(help, HELP);
}

#[test]
fn legal_scenes_and_negative_colours_pass() {
    let text = "[light.a]\nposition = [0, 0, 1]\nspot_cutoff = 90\nspot_exponent = 128\ndiffuse = [-1, 2, 0]\n\
                [material.m]\nshininess = 128\n[object.ball]\nshape = \"sphere\"\nmaterial = \"m\"\n";
    assert_eq!(strict(&[("a.toml", text)]), Ok(()));
    for scene in rastray::import::shipped() {
        let options = LoadOptions {
            strict_gl: true,
            ..LoadOptions::default()
        };
        if let Err(error) = load(scene.name, &options) {
            panic!("{}: {error}", scene.name);
        }
    }
}
