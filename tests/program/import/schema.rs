//! The JSON Schema accepts what the reader accepts, and knows the same keys.

use rastray::import::{schema, shipped};
use serde_json::Value;

/// As much of JSON Schema as the scene file's needs; an unknown keyword is a failure.
fn problems(schema: &Value, value: &Value, at: &str, found: &mut Vec<String>) {
    let Some(keywords) = schema.as_object() else {
        if schema == &Value::Bool(false) {
            found.push(format!("{at}: nothing is allowed"));
        }
        return;
    };
    let mut fail = |what: &str| found.push(format!("{at}: {what}"));
    let matching = |list: &Value| {
        let fits = |s: &&Value| {
            let mut inner = Vec::new();
            problems(s, value, at, &mut inner);
            inner.is_empty()
        };
        list.as_array().unwrap().iter().filter(fits).count()
    };
    let number = value.as_f64();
    for (keyword, rule) in keywords {
        let good = match keyword.as_str() {
            "$schema" | "title" | "description" | "default" => true,
            "type" => match rule.as_str().unwrap() {
                "object" => value.is_object(),
                "array" => value.is_array(),
                "string" => value.is_string(),
                "boolean" => value.is_boolean(),
                "number" => value.is_number(),
                "integer" => value.is_i64() || value.is_u64(),
                other => panic!("type {other}"),
            },
            "const" => value == rule,
            "enum" => rule.as_array().unwrap().contains(value),
            "anyOf" => matching(rule) > 0,
            "oneOf" => matching(rule) == 1,
            "minimum" => number.is_none_or(|x| x >= rule.as_f64().unwrap()),
            "maximum" => number.is_none_or(|x| x <= rule.as_f64().unwrap()),
            "exclusiveMinimum" => number.is_none_or(|x| x > rule.as_f64().unwrap()),
            "exclusiveMaximum" => number.is_none_or(|x| x < rule.as_f64().unwrap()),
            "minItems" => value
                .as_array()
                .is_none_or(|a| a.len() as u64 >= rule.as_u64().unwrap()),
            "maxItems" => value
                .as_array()
                .is_none_or(|a| a.len() as u64 <= rule.as_u64().unwrap()),
            "minProperties" => value
                .as_object()
                .is_none_or(|a| a.len() as u64 >= rule.as_u64().unwrap()),
            "maxProperties" => value
                .as_object()
                .is_none_or(|a| a.len() as u64 <= rule.as_u64().unwrap()),
            "required" => value.as_object().is_none_or(|o| {
                rule.as_array()
                    .unwrap()
                    .iter()
                    .all(|k| o.contains_key(k.as_str().unwrap()))
            }),
            "items" => {
                let mut inner = Vec::new();
                for (i, item) in value.as_array().into_iter().flatten().enumerate() {
                    problems(rule, item, &format!("{at}[{i}]"), &mut inner);
                }
                inner.is_empty()
            }
            "properties" | "additionalProperties" => true, // below
            other => panic!("keyword {other}"),
        };
        if !good {
            fail(&format!("{keyword} {rule}"));
        }
    }
    for (key, item) in value.as_object().into_iter().flatten() {
        let rule = match schema["properties"].get(key) {
            Some(rule) => rule,
            None => schema.get("additionalProperties").unwrap_or(&Value::Null),
        };
        problems(rule, item, &format!("{at}.{key}"), found);
    }
}

fn check(text: &str) -> Vec<String> {
    let schema: Value = serde_json::from_str(&schema()).unwrap();
    let value: Value = toml::from_str(text).unwrap();
    let mut found = Vec::new();
    problems(&schema, &value, "scene", &mut found);
    found
}

#[test]
fn shipped_scenes_are_valid() {
    for scene in shipped() {
        assert_eq!(check(scene.text), Vec::<String>::new(), "{}", scene.name);
    }
}

#[test]
fn the_schema_refuses_what_the_reader_refuses() {
    let ball = "[object.ball]\nshape = \"sphere\"\n";
    for bad in [
        "[camera]\nfov = 3\n",
        "[camera]\nfovy = 180\n",
        "[image]\nwidth = 0\n",
        "[image]\nwidth = 1.5\n",
        "[raster]\nsnap = 9\n",
        "[raster]\nshading = \"pong\"\n",
        "[material.a]\ncolor = [1, 2]\n",
        "[material.a]\ntexture = \"a.png\"\n",
        "[light.a]\ndiffuse = 1\n",
        "[light.a]\nposition = [0, 0, 1]\ndirection = [0, 0, 1]\n",
        "[object.b]\nshape = \"sphere\"\nsize = 3\n",
        "[object.b]\nshape = \"kettle\"\n",
        "[object.b]\nshape = \"teapot\"\ncenter = [0, 0, 0]\n",
        "[object.b]\nshape = \"bezier\"\npoints = [[0, 0, 0]]\npatches = [[0, 0]]\n",
        "[object.b]\nshape = \"torus\"\nradius = 1\n",
        "[object.b]\nshape = \"cylinder\"\ncaps = 1\n",
        "[object.b]\nshape = \"revolution\"\nprofile = [[1, 0, 2], [1, 1, 2]]\n",
        "[object.b]\nshape = \"revolution\"\nprofile = [[1, 0], [1, 1]]\ncurve = \"spline\"\n",
        "[object.b]\nmaterial = \"a\"\n",
        "[object.b]\nshape = \"sphere\"\ntransform = [{ scale = 1, translate = [0, 0, 0] }]\n",
    ] {
        assert!(!check(&format!("{bad}{ball}")).is_empty(), "{bad}");
        assert!(
            super::load_text("a.toml", format!("{bad}{ball}"), &[]).is_err(),
            "{bad}"
        );
    }
    for good in [
        "convention = \"lecture\"\n",
        "[raster]\nsnap = 12\n",
        "[light.a]\ndirection = [0, 0, 1]\nspace = \"eye\"\n",
        "[material.a]\nreflection = \"K_S\"\nback = { color = 1 }\n",
        "[object.b]\npositions = [[0,0,0], [1,0,0], [0,1,0]]\nindices = [[0,1,2]]\nsmooth = true\n",
        "[object.b]\nshape = \"disk\"\ncenter = [0, 1, 0]\nnormal = [0, 0, 1]\nradius = 2\ntessellation = 9\n",
        "[object.b]\nshape = \"cylinder\"\nbase = [0, 1, 0]\ntop = [0, 2, 1]\nradius = 2\ncaps = false\n",
        "[object.b]\nshape = \"cone\"\nbase = [0, 1, 0]\napex = [0, 2, 1]\nradius = 2\ncap = false\n",
        "[object.b]\nshape = \"torus\"\ncenter = [0, 1, 0]\naxis = [0, 0, 1]\nmajor_radius = 2\nminor_radius = 0.5\n",
        "[object.b]\nshape = \"revolution\"\nbase = [0, 1, 0]\naxis = [0, 0, 2]\nprofile = [[0, 0], [1, 0.5], [1, 1]]\ncurve = \"smooth\"\ntessellation = 9\n",
        "[object.b]\nshape = \"teapot\"\nbase = [0, 1, 0]\nheight = 2\ntessellation = 12\n",
        "[object.b]\nshape = \"bezier\"\npoints = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]\npatches = [[0, 0, 1, 1, 0, 0, 1, 1, 2, 2, 3, 3, 2, 2, 3, 3]]\n",
        "[object.b]\nshape = \"box\"\nmin = [0, 0, 0]\nmax = [1, 1, 1]\ntransform = [{ rotate = { axis = [0, 1, 0], degrees = 3 } }, { scale = -1 }]\n",
    ] {
        assert_eq!(
            check(&format!("{good}{ball}")),
            Vec::<String>::new(),
            "{good}"
        );
        super::load_text("a.toml", format!("{good}{ball}"), &[]).unwrap();
    }
}

/// Every key that the schema lists is known to the reader: a wrong type is complained about as a value, not as a key.
#[test]
fn schema_and_reader_know_the_same_keys() {
    let schema: Value = serde_json::from_str(&schema()).unwrap();
    let top = &schema["properties"];
    let mut sections: Vec<(String, Vec<String>)> = Vec::new();
    let keys = |section: &Value| -> Vec<String> {
        section["properties"]
            .as_object()
            .unwrap()
            .keys()
            .cloned()
            .collect()
    };
    for name in ["image", "camera", "light_model", "raster", "trace"] {
        sections.push((format!("[{name}]\n"), keys(&top[name])));
    }
    for name in ["light", "material"] {
        sections.push((
            format!("[{name}.x]\n"),
            keys(&top[name]["additionalProperties"]),
        ));
    }
    for form in top["object"]["additionalProperties"]["oneOf"]
        .as_array()
        .unwrap()
    {
        let properties = form["properties"].as_object().unwrap();
        let start = match properties.get("shape").and_then(|s| s["const"].as_str()) {
            Some(shape) => format!("[object.x]\nshape = \"{shape}\"\n"),
            None if properties.contains_key("mesh") => "[object.x]\nmesh = \"x.obj\"\n".into(),
            None => "[object.x]\npositions = [0, 0, 0, 1, 0, 0, 0, 1, 0]\n".into(),
        };
        sections.push((start, keys(form)));
    }
    let ball = "[object.ball]\nshape = \"sphere\"\n";
    let mut count = 0;
    for (start, keys) in sections {
        for key in keys {
            if start.contains(&format!("\n{key} =")) {
                continue; // it decides the form
            }
            let error =
                super::load_text("a.toml", format!("{start}{key} = 1979-05-27\n{ball}"), &[]);
            let message = error.err().unwrap().to_string();
            assert!(!message.contains("has no key"), "{start}{key}: {message}");
            count += 1;
        }
    }
    assert!(count > 80, "{count}");
}
