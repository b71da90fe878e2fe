//! Test files: dialects of laboratories, and rejected files.

use crate::skipped::shared;
use sinew_creep::{TestFileError, TestOptions, TestQuantity, read_test, read_test_bytes};
use sinew_log::{Cell, CellKind, Table};

fn read(text: &str) -> Result<sinew_creep::TestFile, TestFileError> {
    read_test_bytes(text.as_bytes().to_vec(), "t.csv", &TestOptions::default())
}

fn refusal(text: &str) -> String {
    match read(text) {
        Ok(file) => panic!("read as {:?}", file.source.columns),
        Err(error) => error.to_string(),
    }
}

#[test]
fn units_of_sinew_tables_are_read() {
    let text = "time_s,tension_n,carriage_force_n,elongation_mm,strain_percent,strain_low_percent,temperature_c\n0,100,200,1.5,0.25,0.2,23\n60,100,200,1.6,0.27,0.2,23\n";
    let test = read(text).expect("a test");
    let specimen = &test.specimens[0];
    assert_eq!(
        specimen.column(TestQuantity::Force),
        Some(&[100.0, 100.0][..])
    );
    assert_eq!(
        specimen.column(TestQuantity::Strain),
        Some(&[0.0025, 0.0027][..])
    );
    assert_eq!(
        specimen.column(TestQuantity::Temperature),
        Some(&[23.0, 23.0][..])
    );
    // Without the underscore it is no unit, and none is assumed.
    let text = "time_s,force n,strain_percent\n0,1,2\n1,1,2\n";
    assert!(refusal(text).contains("no unit"));
}

#[test]
fn german_export_with_head_and_units_is_read_in_si() {
    let text = "Prüfung;Zugkriechversuch\nL0 (mm);350,0\nSeil;DC000-0301\n\nPrüfzeit;Standardkraft;Standardweg\ns;N;mm\n0,0;1,5;0,000\n1,5;60,0;0,700\n";
    let file = read(text).unwrap();
    assert_eq!(file.specimens.len(), 1);
    let s = &file.specimens[0];
    assert_eq!(s.name, "t");
    assert_eq!(s.column(TestQuantity::Time), Some(&[0.0, 1.5][..]));
    assert_eq!(s.column(TestQuantity::Force), Some(&[1.5, 60.0][..]));
    let elongation = s.column(TestQuantity::Elongation).unwrap();
    assert!((elongation[1] - 0.7e-3).abs() < 1e-18);
    let length = s.constant(TestQuantity::GaugeLength).unwrap();
    assert!((length - 0.35).abs() < 1e-15);
    assert_eq!(s.attribute("Seil"), Some("DC000-0301"));
}

#[test]
fn units_are_read_at_customary_positions() {
    for header in [
        "time_min,force_daN,strain_percent",
        "Time (min),Force [daN],Strain (%)",
        "t / min,F / daN,epsilon / %",
        "\"Time, min\",\"Load, daN\",\"Strain, %\"",
    ] {
        let file = read(&format!("{header}\n0,0,0\n2,6,0.5\n")).unwrap();
        let s = &file.specimens[0];
        assert_eq!(s.column(TestQuantity::Time).unwrap()[1], 120.0, "{header}");
        assert_eq!(s.column(TestQuantity::Force).unwrap()[1], 60.0, "{header}");
        let strain = s.column(TestQuantity::Strain).unwrap()[1];
        assert!((strain - 0.005).abs() < 1e-17, "{header}");
    }
}

/// `sinew creep analyze --series` writes these columns.
#[test]
fn names_that_end_in_si_units_are_read() {
    let text =
        "specimen,time_s,strain_ratio,force_n,temperature_c\na,0,0,1.5,23\na,2,0.005,60,23\n";
    let file = read(text).unwrap();
    let s = &file.specimens[0];
    assert_eq!(s.column(TestQuantity::Force), Some(&[1.5, 60.0][..]));
    assert_eq!(s.column(TestQuantity::Strain), Some(&[0.0, 0.005][..]));
    assert_eq!(s.column(TestQuantity::Temperature), Some(&[23.0, 23.0][..]));
    assert!(file.source.notes.is_empty(), "{:?}", file.source.notes);
}

#[test]
fn specimens_are_separated_by_name_and_clock_restart() {
    let file = read(
        "time_s,strain_1,rope,no\n0,0,a,1\n9,1e-3,a,1\n0,0,b,1\n9,2e-3,b,1\n0,0,b,1\n9,3e-3,b,1\n",
    )
    .unwrap();
    let names: Vec<&str> = file.specimens.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["a", "b", "b #2"]);
    assert_eq!(file.specimens[2].attribute("no"), Some("1"));
    // A file with the latest sample first is one specimen, too.
    let file = read("time_s,strain_1\n9,3e-3\n5,2e-3\n1,1e-3\n").unwrap();
    assert_eq!(file.specimens.len(), 1);
    // A small step back is an artefact of the recording and stays in the specimen.
    let file = read("time_s,strain_1\n0,0\n9,1e-3\n8,1e-3\n10,1e-3\n").unwrap();
    assert_eq!(file.specimens.len(), 1);
}

#[test]
fn ambiguous_unit_is_never_assumed() {
    assert!(refusal("time_s,force,strain_1\n0,0,0\n1,1,1\n").contains("force=force:N"));
    assert!(refusal("time,force_N,strain_1\n0,0,0\n1,1,1\n").contains("time=time:s"));
    assert!(refusal("time_s,force (mm),strain_1\n0,0,0\n1,1,1\n").contains("is not a unit of it"));
    assert!(
        refusal("time_s,force (stone),strain_1\n0,0,0\n1,1,1\n").contains("unknown unit 'stone'")
    );
    let file = read("time_s,strain\n0,0\n1,1e-3\n").unwrap();
    assert!(
        file.source.notes[0].contains("interpreted as a ratio"),
        "{:?}",
        file.source.notes
    );
}

#[test]
fn invalid_test_is_rejected_with_location() {
    assert!(refusal("a_s,b\n0,0\n1,1\n").contains("no column is a time"));
    assert!(refusal("time_s,force_N\n0,0\n1,1\n").contains("no column is an elongation"));
    assert!(refusal("time_s,strain_1\n0,0\n1,oops\n2,0\n").contains("line 3, column 'strain_1'"));
    assert!(refusal("1,2\n3,4\n").contains("no header"));
    assert!(refusal("").contains("empty"));
    assert!(
        read("time_s,strain_1\n0,0\n1,1e-3\n2,oops")
            .unwrap()
            .source
            .notes[0]
            .contains("incomplete")
    );
    let old = read_test_bytes(
        b"\xd0\xcf\x11\xe0aaaaaaaa".to_vec(),
        "a.xls",
        &TestOptions::default(),
    );
    assert!(old.unwrap_err().to_string().contains(".xlsx"));
    for damaged in [&b"PK\x03\x04rubbish"[..], b"PAR1rubbishPAR1", b"\0\0\0"] {
        assert!(read_test_bytes(damaged.to_vec(), "x", &TestOptions::default()).is_err());
    }
}

#[test]
fn user_columns_override_headers_and_suggest_names() {
    let mut options = TestOptions {
        columns: vec![
            "time=clock:min".parse().unwrap(),
            "strain=gauge_a:%".parse().unwrap(),
        ],
        ..TestOptions::default()
    };
    let text = b"clock,gauge_a,strain_1\n0,0,7\n1,2,7\n".to_vec();
    let file = read_test_bytes(text.clone(), "t.csv", &options).unwrap();
    assert_eq!(
        file.specimens[0].column(TestQuantity::Time).unwrap()[1],
        60.0
    );
    assert_eq!(
        file.specimens[0].column(TestQuantity::Strain).unwrap()[1],
        0.02
    );
    options.columns[0].column = "clok".to_owned();
    let error = read_test_bytes(text, "t.csv", &options)
        .unwrap_err()
        .to_string();
    assert!(error.contains("did you mean 'clock'"), "{error}");
    assert!(
        "force=a:stone"
            .parse::<sinew_creep::ColumnChoice>()
            .is_err()
    );
    assert!("weight=a".parse::<sinew_creep::ColumnChoice>().is_err());
}

#[test]
fn all_204_spruce_tests_are_separate_specimens() {
    let path = "data/creep/ferrara_wittel_spruce_creep/ve_creep_all.csv";
    let Some(path) = shared(path) else {
        return;
    };
    let file = read_test(&path, &TestOptions::default()).unwrap();
    assert_eq!(file.specimens.len(), 204);
    assert_eq!(
        file.specimens.iter().map(|s| s.lines.len()).sum::<usize>(),
        4713
    );
    let first = &file.specimens[0];
    assert_eq!(first.constant(TestQuantity::Force), Some(133.0));
    assert_eq!(first.constant(TestQuantity::Humidity), Some(30.0));
    let hour = first.column(TestQuantity::Time).unwrap()[1] / 3600.0;
    assert!((hour - 0.008_333_333_3).abs() < 1e-15);
}

#[test]
fn csv_and_parquet_give_identical_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let mut table = Table::new(&[
        ("time_s", CellKind::Number),
        ("force_n", CellKind::Number),
        ("strain_ratio", CellKind::Number),
    ]);
    for row in 0..50 {
        let x = f64::from(row);
        table.push(vec![
            (x / 3.0).into(),
            (60.0 + x / 7.0).into(),
            (1e-3 * x.sqrt()).into(),
        ]);
    }
    let options = TestOptions {
        columns: vec!["force=force_n:N".parse().unwrap()],
        ..TestOptions::default()
    };
    let read = |name: &str| {
        let path = folder.path().join(name);
        table.write(&path).unwrap();
        let file = read_test(&path, &options).unwrap();
        file.specimens[0].clone()
    };
    let (csv, parquet) = (read("a.csv"), read("a.parquet"));
    for quantity in TestQuantity::ALL {
        assert_eq!(csv.column(quantity), parquet.column(quantity));
    }
    let number = |cell: &Cell| match cell {
        Cell::Number(x) => *x,
        _ => f64::NAN,
    };
    let strain: Vec<f64> = table.rows.iter().map(|row| number(&row[2])).collect();
    assert_eq!(csv.column(TestQuantity::Strain), Some(&strain[..]));
}

#[test]
fn units_in_brackets_below_header_are_read() {
    for units in ["\"(s)\",\"(mm)\",\"(N)\"", "(sec),(mm),(N)", "[s],[mm],[N]"] {
        let text = format!(
            "\"Specimen label\",\"rope-1\"\n\"Time\",\"Extension\",\"Load\"\n{units}\n\"0.0\",\"0.0\",\"2.0\"\n\"10.0\",\"2.5\",\"99.8\"\n"
        );
        let file = read(&text).unwrap();
        let s = &file.specimens[0];
        assert_eq!(s.column(TestQuantity::Time), Some(&[0.0, 10.0][..]));
        assert_eq!(s.column(TestQuantity::Elongation), Some(&[0.0, 0.0025][..]));
        assert_eq!(s.column(TestQuantity::Force), Some(&[2.0, 99.8][..]));
        assert_eq!(
            file.source.columns[0].unit.trim_matches(['(', ')']),
            file.source.columns[0].unit
        );
    }
}

#[test]
fn comments_of_other_programs_are_skipped() {
    for mark in ["#", "%", "//", ";"] {
        let text = format!(
            "{mark} test of monday\n{mark} L0 (mm), 350\n{mark} time_s,force_N,elongation_mm\n0,1,0\n{mark} pause\n1,1,0.5\n"
        );
        let file = read(&text).unwrap_or_else(|error| panic!("{mark}: {error}"));
        let s = &file.specimens[0];
        assert_eq!(
            s.column(TestQuantity::Time),
            Some(&[0.0, 1.0][..]),
            "{mark}"
        );
        assert_eq!(file.source.columns[0].column, "time_s");
        assert!((s.constant(TestQuantity::GaugeLength).unwrap() - 0.35).abs() < 1e-15);
        let text = format!("time_s,force_N,elongation_mm\n{mark} first, second\n0,1,0\n1,1,0.5\n");
        let file = read(&text).unwrap_or_else(|error| panic!("{mark}: {error}"));
        assert_eq!(file.specimens[0].lines, [3, 4], "{mark}");
    }
}

#[test]
fn clock_times_and_thousands_are_read() {
    let rows = [
        (
            "00:00:50",
            "2024-03-01 10:00:50",
            "1.3.2024 10:00:50,0",
            "10:00:50 AM",
        ),
        (
            "00:01:00",
            "2024-03-01 10:01:00",
            "1.3.2024 10:01:00,0",
            "10:01:00 AM",
        ),
    ];
    for header in [
        "Zeit",
        "Time [hh:mm:ss]",
        "Uhrzeit",
        "Date/Time",
        "timestamp",
    ] {
        for pick in [
            |row: &(&'static str, &'static str, &'static str, &'static str)| row.0,
            |row: &(&'static str, &'static str, &'static str, &'static str)| row.1,
            |row: &(&'static str, &'static str, &'static str, &'static str)| row.2,
            |row: &(&'static str, &'static str, &'static str, &'static str)| row.3,
        ] {
            let [first, second] = [pick(&rows[0]), pick(&rows[1])];
            let text = format!(
                "{header};Kraft [N];Dehnung [%]\n{first};2,0;0,0\n{second};1.099,8;0,8077\n"
            );
            let file = read(&text).unwrap_or_else(|error| panic!("{text}: {error}"));
            let s = &file.specimens[0];
            let time = s.column(TestQuantity::Time).unwrap();
            assert!((time[1] - time[0] - 10.0).abs() < 1e-6, "{text}: {time:?}");
            assert_eq!(s.column(TestQuantity::Force), Some(&[2.0, 1099.8][..]));
        }
    }
    // A time in seconds has a finer resolution than a clock next to it.
    let text = "Uhrzeit;Zeit [s];Kraft [N];Dehnung [%]\n10:00:00;0,0;1.000;0,1\n10:00:00;0,5;1.099,8;0,2\n";
    let file = read(text).unwrap();
    let s = &file.specimens[0];
    assert_eq!(file.specimens.len(), 1);
    assert_eq!(s.column(TestQuantity::Time), Some(&[0.0, 0.5][..]));
    assert_eq!(s.column(TestQuantity::Force), Some(&[1000.0, 1099.8][..]));
    // Midnight is no second specimen.
    let text = "Zeit;Kraft [N];Dehnung [%]\n23:59:50;60;0,1\n00:00:00;60;0,2\n00:00:10;60;0,3\n";
    let file = read(text).unwrap();
    assert_eq!(file.specimens.len(), 1);
    assert_eq!(
        file.specimens[0].column(TestQuantity::Time),
        Some(&[86_390.0, 86_400.0, 86_410.0][..])
    );
}

#[test]
fn dates_without_seconds_are_read() {
    for (first, second) in [
        ("01.03.2024 23:58", "02.03.2024 00:08"),
        ("2024-03-01 23:58", "2024-03-02 00:08"),
        ("2024-03-01T23:58Z", "2024-03-02T00:08Z"),
    ] {
        let text = format!("Datum;Kraft [N];Dehnung [%]\n{first};60;0,1\n{second};60;0,2\n");
        let file = read(&text).unwrap_or_else(|error| panic!("{text}: {error}"));
        let time = file.specimens[0].column(TestQuantity::Time).unwrap();
        assert!((time[1] - time[0] - 600.0).abs() < 1e-6, "{text}: {time:?}");
    }
}

/// Names of the specimens, and a column of each.
fn columns(text: &str, quantity: TestQuantity) -> Vec<(String, Vec<f64>)> {
    let file = read(text).unwrap_or_else(|error| panic!("{text}: {error}"));
    let specimens = file.specimens.into_iter();
    let column = |s: &sinew_creep::Specimen| s.column(quantity).unwrap_or_default().to_vec();
    specimens.map(|s| (s.name.clone(), column(&s))).collect()
}

#[test]
fn specimens_in_columns_are_read_separately() {
    for header in [
        "time_h,A_mm,B_mm,C_mm",
        "time_h,elongation A [mm],elongation B [mm],elongation C [mm]",
        "time_h,elongation_A_mm,elongation_B_mm,elongation_C_mm",
        "\"Time, h\",Rope A (mm),Rope B (mm),Rope C (mm)",
    ] {
        let text = format!("{header}\n0,0,0,0\n1,1.5,2.5,3.5\n2,2,3,\n");
        let read = columns(&text, TestQuantity::Elongation);
        let names: Vec<&str> = read.iter().map(|s| s.0.as_str()).collect();
        assert_eq!(names, ["A", "B", "C"], "{header}");
        let lengths: Vec<usize> = read.iter().map(|s| s.1.len()).collect();
        assert_eq!(lengths, [3, 3, 2], "{header}");
        assert!((read[1].1[1] - 2.5e-3).abs() < 1e-15, "{header}");
        let time = columns(&text, TestQuantity::Time);
        assert_eq!(time[2].1, [0.0, 3600.0], "{header}");
    }
    // Times, forces and strains of each specimen, and a temperature of all.
    let text = "time 1 [s],time 2 [s],force 1 [N],force 2 [N],strain 1 [%],strain 2 [%],temperature_c\n\
                0,5,60,80,0,0,23\n10,15,60,80,1,2,23\n";
    let force = columns(text, TestQuantity::Force);
    let names: Vec<&str> = force.iter().map(|s| s.0.as_str()).collect();
    assert_eq!(names, ["strain 1", "strain 2"]);
    assert_eq!(force[1].1, [80.0, 80.0]);
    assert_eq!(columns(text, TestQuantity::Time)[1].1, [5.0, 15.0]);
    assert_eq!(columns(text, TestQuantity::Temperature)[1].1, [23.0, 23.0]);
    // The user selects one, or names several.
    let text = "time_h,A_mm,B_mm\n0,0,0\n1,1.5,2.5\n";
    for (chosen, expected) in [
        (&["elongation=B_mm"][..], &["t"][..]),
        (&["elongation=A_mm", "elongation=B_mm"], &["A", "B"]),
    ] {
        let options = TestOptions {
            columns: chosen
                .iter()
                .map(|choice| choice.parse().unwrap())
                .collect(),
            ..TestOptions::default()
        };
        let file = read_test_bytes(text.as_bytes().to_vec(), "t.csv", &options).unwrap();
        let names: Vec<&str> = file.specimens.iter().map(|s| s.name.as_str()).collect();
        assert_eq!(names, expected);
    }
    let note = &read(text).unwrap().source.notes[0];
    assert!(
        note.contains("'A_mm', 'B_mm'") && note.contains("--column elongation=A_mm:mm"),
        "{note}"
    );
}

/// Gauges, axes and dimensions of one specimen are no specimens.
#[test]
fn columns_of_one_specimen_are_not_separated() {
    for header in [
        "time_s,strain axial [%],strain lateral [%]",
        "time_s,elongation x [mm],elongation y [mm]",
        "time_s,Standardweg [mm],Traversenweg [mm]",
    ] {
        let file = read(&format!("{header}\n0,0,0\n1,1,2\n")).unwrap();
        assert_eq!(file.specimens.len(), 1, "{header}");
        let note = file.source.notes.last().unwrap();
        assert!(note.contains("is not used"), "{note}");
    }
    for header in [
        "time_s,x_mm,y_mm",
        "time_s,L_mm,D_mm",
        "time_s,width_mm,diameter_mm",
    ] {
        let error = refusal(&format!("{header}\n0,0,0\n1,1,2\n"));
        assert!(error.contains("no column is an elongation"), "{error}");
        assert!(error.contains("elongation=COLUMN:mm"), "{error}");
    }
    let options = TestOptions {
        columns: vec!["time=a:s".parse().unwrap(), "time=b:s".parse().unwrap()],
        ..TestOptions::default()
    };
    let text = b"a,b,strain_1\n0,0,0\n1,1,0\n".to_vec();
    let error = read_test_bytes(text, "t.csv", &options).unwrap_err();
    assert!(
        error.to_string().contains("time is set by 2 columns"),
        "{error}"
    );
}

#[test]
fn rows_of_named_specimens_may_alternate() {
    let text = "specimen,time_s,strain_1\na,0,0\nb,0,0\na,5,1e-3\nb,5,2e-3\na,9,2e-3\nb,9,3e-3\n";
    let strain = columns(text, TestQuantity::Strain);
    assert_eq!(
        strain,
        [
            ("a".to_owned(), vec![0.0, 1e-3, 2e-3]),
            ("b".to_owned(), vec![0.0, 2e-3, 3e-3])
        ]
    );
}

#[test]
fn mixed_specimens_are_noted() {
    let rows = |values: &dyn Fn(usize) -> String| -> String {
        (0..20)
            .map(|i| format!("{i},{}e-4,{}\n", i, values(i)))
            .collect()
    };
    let two = |i: usize| if i < 10 { "1.0" } else { "1.5" }.to_owned();
    for header in ["diameter_mm", "L0 [mm]", "Durchmesser [mm]"] {
        let file = read(&format!("time_s,strain_1,{header}\n{}", rows(&two))).unwrap();
        assert_eq!(file.specimens.len(), 1);
        let notes = &file.source.notes;
        assert!(
            notes
                .iter()
                .any(|n| n.contains("2 values") && n.contains("--specimen")),
            "{header}: {notes:?}"
        );
        // A measured diameter has as many values as rows.
        let signal = |i: usize| format!("1.0{i}");
        let file = read(&format!("time_s,strain_1,{header}\n{}", rows(&signal))).unwrap();
        assert_eq!(file.source.notes, [""; 0], "{header}");
    }
    // A column of specimens next to the specified one.
    let options = TestOptions {
        specimen_columns: vec!["rope".to_owned()],
        ..TestOptions::default()
    };
    let rows = rows(&|i| format!("dc,{}", two(i)));
    let text = format!("time_s,strain_1,rope,sample\n{rows}");
    let file = read_test_bytes(text.into_bytes(), "t.csv", &options).unwrap();
    let note = &file.source.notes[0];
    assert!(
        note.contains("'sample' has 2 values") && note.contains("'dc'"),
        "{note}"
    );
}
