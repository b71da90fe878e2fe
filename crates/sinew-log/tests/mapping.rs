//! Invalid mappings are errors with file, line and reason.

use sinew_log::Mapping;

fn refused(text: &str, line: usize, words: &[&str]) {
    let message = Mapping::from_toml(text, "map.toml")
        .unwrap_err()
        .to_string();
    assert!(
        message.starts_with(&format!("map.toml, line {line}: ")),
        "{message}\n{text}"
    );
    for word in words {
        assert!(message.contains(word), "'{word}' is not in: {message}");
    }
}

fn joint(source: &str) -> String {
    format!("[joints.a]\nq = {source}\n")
}

#[test]
fn keys_and_types() {
    refused("[tme]\ncolumn = \"t\"\n", 1, &["unknown key", "tme"]);
    refused(
        "[joints.a]\nposition = { column = \"x\" }\n",
        2,
        &["unknown key", "position", "theta"],
    );
    refused(&joint("{ colum = \"x\" }"), 2, &["unknown key", "colum"]);
    refused(&joint("{ column = 0 }"), 2, &["its number from 1"]);
    refused("[joints.a]\nq = { column = \"x\"\n", 2, &[]);
    refused(
        "[mcap]\ntopic = \"x\"\n",
        2,
        &["unknown key", "motor_topic"],
    );
    refused(
        "[mcap]\njoint_effort = \"force\"\n",
        2,
        &["\"force\"", "tau_el"],
    );
    refused("[time]\nunit = \"min\"\n", 2, &["'min'", "s, ms, us, ns"]);
    refused(
        "[joints.\"\"]\nq = { column = \"x\" }\n",
        1,
        &["without a name"],
    );
}

#[test]
fn units_and_factors() {
    refused(
        &joint("{ column = \"x\", unit = \"gradians\" }"),
        2,
        &["unknown unit 'gradians'", "deg"],
    );
    refused(
        &joint("{ column = \"x\", unit = \"N·m\" }"),
        2,
        &["a unit of q", "scale"],
    );
    refused(
        &joint("{ column = \"x\", unit = \"count\" }"),
        2,
        &["counts_per_turn"],
    );
    refused(
        &joint("{ column = \"x\", counts_per_turn = 4096 }"),
        2,
        &["count"],
    );
    refused(
        &joint("{ column = \"x\", gear_ratio = 0.0 }"),
        2,
        &["gear_ratio = 0", "not zero"],
    );
    refused(
        &joint("{ column = \"x\", scale = nan }"),
        2,
        &["scale = nan"],
    );
    refused(
        &joint("{ column = \"x\", scale = 1e300, gear_ratio = 1e-300 }"),
        2,
        &["inf"],
    );
    refused(
        &joint("{ column = \"x\", sign = 2 }"),
        2,
        &["sign = 2", "must be 1 or -1"],
    );
    refused(
        &joint("{ column = \"x\", offset = inf }"),
        2,
        &["offset = inf"],
    );
    refused(
        &joint("{ column = \"x\", wrap_period = -1.0 }"),
        2,
        &["wrap_period = -1"],
    );
    refused(
        &joint("{ column = \"x\", wrap_period = 1.0, wrap = false }"),
        2,
        &["conflicts"],
    );
    refused(
        "[joints.a]\ntau_m = { column = \"x\", wrap_period = 1.0 }\n",
        2,
        &["only positions"],
    );
    refused(&joint("{ sum = [] }"), 2, &["no terms"]);
    refused(
        &joint("{ sum = [ { scale = 2.0 } ] }"),
        2,
        &["without a column"],
    );
    refused(
        &joint("{ column = \"x\", sum = [ { column = \"y\" } ] }"),
        2,
        &["sum"],
    );
    refused(
        &joint("{ sum = [ { column = \"y\", sum = [] } ] }"),
        2,
        &["unknown key"],
    );
}

#[test]
fn current_needs_torque_constant_and_is_motor_torque() {
    let motor = |source: &str| format!("[joints.a]\ntau_m = {source}\n");
    let constant = "torque_constant_nm_per_a";
    for (source, words) in [
        ("{ column = \"i\", unit = \"A\" }", [constant, "shaft"]),
        // A scale alone hides what it stands for.
        (
            "{ column = \"i\", unit = \"A\", scale = 5.0 }",
            [constant, "shaft"],
        ),
        (
            "{ column = \"i\", unit = \"N·m\", torque_constant_nm_per_a = 0.05 }",
            [constant, "\"A\""],
        ),
        (
            "{ column = \"i\", unit = \"A\", torque_constant_nm_per_a = 0.0 }",
            [constant, "not zero"],
        ),
        (
            "{ column = \"i\", unit = \"A\", torque_constant_nm_per_a = -0.05 }",
            [constant, "sign"],
        ),
    ] {
        refused(&motor(source), 2, &words);
    }
    let current = "{ column = \"i\", unit = \"mA\", torque_constant_nm_per_a = 0.05 }";
    let elastic = format!("[joints.a]\ntau_el = {current}\n");
    refused(&elastic, 2, &["current", "tau_m", "tau_el"]);
    refused(&joint(current), 2, &["current", "tau_m"]);
    let mapping = Mapping::from_toml(&motor(current), "map.toml").unwrap();
    assert!(mapping.reads_motor_current());
    let torque = motor("{ column = \"i\", unit = \"N·m\" }");
    let mapping = Mapping::from_toml(&torque, "map.toml").unwrap();
    assert!(!mapping.reads_motor_current());
}

#[test]
fn joints_keep_the_order_of_the_file() {
    let text =
        "[joints.z]\nq = { column = \"1\" }\n[joints.a]\nq = { column = \"2\" }\n[joints.m]\n";
    let mapping = Mapping::from_toml(text, "map.toml").unwrap();
    assert_eq!(mapping.joint_names().collect::<Vec<_>>(), ["z", "a", "m"]);
}

#[test]
fn shipped_mappings_are_valid() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/mappings");
    let mut read = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let mapping = Mapping::read(&entry.unwrap().path()).unwrap();
        assert!(mapping.joint_names().count() > 0);
        read += 1;
    }
    assert!(read >= 2);
}

#[test]
fn not_a_mapping() {
    assert!(Mapping::from_toml("", "map.toml").is_ok());
    assert!(Mapping::from_toml("\u{feff}[time]\n", "map.toml").is_ok());
    assert!(Mapping::from_toml(&"#".repeat(5 << 20), "map.toml").is_err());
    assert!(Mapping::read(std::path::Path::new("/no/such.toml")).is_err());
}
