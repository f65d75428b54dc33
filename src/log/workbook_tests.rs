//! Workbooks, written part by part: what Excel writes, and what nobody should.

use std::fmt::Write as _;
use std::io::{Cursor, Write as _};
use std::path::Path;

use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use super::*;
use crate::error::{Error, Result};

const STYLES: &str = "<styleSheet xmlns=\"http://schemas.openxmlformats.org/spreadsheetml/2006/main\"><numFmts count=\"1\"><numFmt numFmtId=\"164\" formatCode=\"yyyy-mm-dd hh:mm:ss.000\"/></numFmts><cellXfs count=\"3\"><xf numFmtId=\"0\"/><xf numFmtId=\"164\"/><xf numFmtId=\"46\"/></cellXfs></styleSheet>";

fn part(archive: &mut ZipWriter<Cursor<Vec<u8>>>, name: &str, content: &str) {
    archive.start_file(name, SimpleFileOptions::default()).unwrap();
    archive.write_all(content.as_bytes()).unwrap();
}

/// A workbook of sheets, each a name and the content of its `sheetData`.
fn workbook(sheets: &[(&str, &str)]) -> Vec<u8> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let types = "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\"/>";
    part(&mut archive, "[Content_Types].xml", types);
    let relation = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
    let package = "http://schemas.openxmlformats.org/package/2006/relationships";
    part(
        &mut archive,
        "_rels/.rels",
        &format!(
            "<Relationships xmlns=\"{package}\"><Relationship Id=\"rId1\" Type=\"{relation}/officeDocument\" Target=\"xl/workbook.xml\"/></Relationships>"
        ),
    );
    let (mut names, mut targets) = (String::new(), String::new());
    for (index, (name, rows)) in sheets.iter().enumerate() {
        let id = index + 1;
        write!(names, "<sheet name=\"{name}\" sheetId=\"{id}\" r:id=\"rId{id}\"/>").unwrap();
        write!(targets, "<Relationship Id=\"rId{id}\" Type=\"{relation}/worksheet\" Target=\"worksheets/sheet{id}.xml\"/>").unwrap();
        let main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
        let sheet = format!(
            "<?xml version=\"1.0\"?><worksheet xmlns=\"{main}\"><sheetData>{rows}</sheetData></worksheet>"
        );
        part(&mut archive, &format!("xl/worksheets/sheet{id}.xml"), &sheet);
    }
    part(
        &mut archive,
        "xl/workbook.xml",
        &format!(
            "<workbook xmlns=\"http://schemas.openxmlformats.org/spreadsheetml/2006/main\" xmlns:r=\"{relation}\"><sheets>{names}</sheets></workbook>"
        ),
    );
    part(
        &mut archive,
        "xl/_rels/workbook.xml.rels",
        &format!("<Relationships xmlns=\"{package}\">{targets}</Relationships>"),
    );
    part(&mut archive, "xl/styles.xml", STYLES);
    archive.finish().unwrap().into_inner()
}

fn text(at: &str, words: &str) -> String {
    format!("<c r=\"{at}\" t=\"inlineStr\"><is><t>{words}</t></is></c>")
}

fn number(at: &str, value: &str) -> String {
    format!("<c r=\"{at}\"><v>{value}</v></c>")
}

/// The header of a table that begins at A1, and rows with what stands in them.
fn table(rows: &[&[String]]) -> String {
    let header =
        format!("<row r=\"1\">{}{}</row>", text("A1", "time_s"), text("B1", "deviation_um"));
    rows.iter().enumerate().fold(header, |all, (index, cells)| {
        format!("{all}<row r=\"{}\">{}</row>", index + 2, cells.concat())
    })
}

fn plain_table() -> String {
    table(&[
        &[number("A2", "0")],
        &[number("A3", "0.1"), number("B3", "6.3"), text("D3", "a note")],
        &[number("A4", "0.2"), number("B4", "-1.5")],
    ])
}

fn with(bytes: &[u8], format: &Format) -> Result<Log> {
    read_bytes(bytes, Path::new("run1.xlsx"), format)
}

#[track_caller]
fn is_plain(bytes: &[u8], format: &Format) {
    let log = with(bytes, format).unwrap_or_else(|e| panic!("{e}"));
    let found: Vec<_> = log.readings().iter().map(|r| (r.time_s, r.deviation_mm)).collect();
    assert_eq!(found, [(0.0, None), (0.1, Some(0.0063)), (0.2, Some(-0.0015))]);
}

fn refused(bytes: &[u8]) -> Error {
    let error = with(bytes, &Format::default()).expect_err("the workbook should be refused");
    assert!(error.hint.is_some(), "{error}");
    error
}

#[test]
fn the_sheet_that_holds_something() {
    let table = plain_table();
    is_plain(&workbook(&[("Log", &table)]), &Format::default());
    let empty = "<row r=\"1\"><c r=\"A1\" s=\"1\"/></row>";
    is_plain(&workbook(&[("Sheet1", ""), ("Log", &table), ("Sheet3", empty)]), &Format::default());
    let several = workbook(&[("Run 1", &table), ("Run 2", &table)]);
    let error = refused(&several);
    assert_eq!(error.what, "the workbook has 2 sheets: `Run 1`, `Run 2`");
    assert!(error.hint.is_some_and(|hint| hint.contains("`sheet = \"Run 1\"`")));
    let named = |name: &str| Format { sheet: Some(name.to_owned()), ..Format::default() };
    is_plain(&several, &named("Run 2"));
    is_plain(&several, &named("run 2"));
    let error = with(&several, &named("Run 3")).unwrap_err();
    assert!(error.what.contains("no sheet `Run 3`; it has `Run 1`, `Run 2`"));
}

#[test]
fn a_place_is_a_row_of_the_sheet() {
    let far = format!(
        "<row r=\"4\">{}{}</row><row r=\"9\">{}{}</row>",
        text("C4", "time_s"),
        text("D4", "deviation_um"),
        number("C9", "0"),
        text("D9", "bad")
    );
    let error = refused(&workbook(&[("Log", &far)]));
    assert_eq!(error.what, "`bad` is not a number");
    assert_eq!(error.place.map(|place| place.line), Some(9));
    // Errors of formulas are no readings.
    let error = "<c r=\"B2\" t=\"e\"><v>#N/A</v></c>".to_owned();
    let rows = table(&[&[number("A2", "0"), error], &[number("A3", "0.1"), number("B3", "6.3")]]);
    let log = with(&workbook(&[("Log", &rows)]), &Format::default()).unwrap();
    assert_eq!(log.notes(), ["1 reading(s) are `#N/A` and count as out of range"]);
}

#[test]
fn times_that_excel_shows_as_dates() {
    let date = |at: &str, days: f64| format!("<c r=\"{at}\" s=\"1\"><v>{days}</v></c>");
    // Half a second before midnight and half a second after it.
    let second = 1.0 / 86_400.0;
    let rows = table(&[
        &[date("A2", 46_349.0 - 0.5 * second), number("B2", "1")],
        &[date("A3", 46_349.0 + 0.5 * second), number("B3", "2")],
    ]);
    let log = with(&workbook(&[("Log", &rows)]), &Format::default()).unwrap();
    assert!((log.span_s() - 1.0).abs() < 3e-6, "{}", log.span_s());
    // A duration, [h]:mm:ss, of more than a day.
    let rows = table(&[
        &["<c r=\"A2\" s=\"2\"><v>1.5</v></c>".to_owned(), number("B2", "1")],
        &["<c r=\"A3\" s=\"2\"><v>1.75</v></c>".to_owned(), number("B3", "2")],
    ]);
    let log = with(&workbook(&[("Log", &rows)]), &Format::default()).unwrap();
    assert_eq!(log.span_s(), 21_600.0);
}

#[test]
fn formulas_have_the_value_that_is_stored() {
    let formula = |value: &str| format!("<c r=\"B2\"><f>A2*2</f>{value}</c>");
    let rows = |value: &str| {
        workbook(&[(
            "Log",
            &table(&[
                &[number("A2", "0"), formula(value)],
                &[number("A3", "1"), number("B3", "2")],
            ]),
        )])
    };
    let log = with(&rows("<v>6.3</v>"), &Format::default()).unwrap();
    assert_eq!(log.readings()[0].deviation_mm, Some(0.0063));
    let error = refused(&rows(""));
    assert!(error.what.contains("the formula in B2 has no stored value"), "{error}");
}

#[test]
fn a_million_rows() {
    let mut rows = table(&[]);
    for row in 2..=1_048_576_u32 {
        write!(
            rows,
            "<row r=\"{row}\"><c r=\"A{row}\"><v>{}</v></c><c r=\"B{row}\"><v>1.5</v></c></row>",
            f64::from(row) / 100.0
        )
        .unwrap();
    }
    let log = with(&workbook(&[("Log", &rows)]), &Format::default()).unwrap();
    assert_eq!(log.readings().len(), 1_048_575);
}

#[test]
fn workbooks_that_nobody_should_write() {
    let far = |at: &str| workbook(&[("Log", &format!("<row>{}</row>", number(at, "1")))]);
    assert!(refused(&far("A9999999")).what.contains("stands where no cell can"));
    assert!(refused(&far("AAAA1")).hint.is_some());
    let twice = format!("<row r=\"1\">{}{}</row>", number("A1", "1"), number("A1", "2"));
    assert!(refused(&workbook(&[("Log", &twice)])).what.contains("cell A1 stands"));
    // A wide sheet: one cell a row, far to the right.
    let mut wide = String::new();
    for row in 1..40_000 {
        write!(wide, "<row r=\"{row}\">{}</row>", number(&format!("XFD{row}"), "1")).unwrap();
    }
    assert!(refused(&workbook(&[("Log", &wide)])).what.contains("128 MiB of text"));
    let long =
        format!("<row r=\"1\"><c r=\"A1\" t=\"str\"><v>{}</v></c></row>", "x".repeat(200_000));
    assert!(refused(&workbook(&[("Log", &long)])).what.contains("more than 32767 letters"));
    // What the library would make room for before it looks.
    let shared = "<row r=\"1\"><c r=\"A1\"><f t=\"shared\" si=\"4000000000\" ref=\"A1:A2\">1</f><v>1</v></c></row>";
    assert!(refused(&workbook(&[("Log", shared)])).what.contains("announces more"));
    let word = "<row r=\"1\"><c r=\"A1\" t=\"n\"><v>infinity</v></c></row>";
    assert!(refused(&workbook(&[("Log", word)])).what.contains("a number of the workbook is"));
    let whole = workbook(&[("Log", &plain_table())]);
    assert!(refused(&whole[..whole.len() / 2]).what.contains("damaged"));
    assert!(
        refused(&[0xD0, 0xCF, 0x11, 0xE0, 0xA1, 0xB1, 0x1A, 0xE1]).what.contains("old workbook")
    );
    assert!(refused(&workbook(&[("Log", "")])).hint.is_some());
    assert!(refused(&workbook(&[])).what.contains("is empty"));
}

#[test]
fn what_unpacks_too_large_is_not_unpacked() {
    let blanks = " ".repeat(1 << 20);
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    archive.start_file("xl/sharedStrings.xml", SimpleFileOptions::default()).unwrap();
    for _ in 0..65 {
        archive.write_all(blanks.as_bytes()).unwrap();
    }
    let bytes = archive.finish().unwrap().into_inner();
    assert!(bytes.len() < 1 << 20);
    assert!(refused(&bytes).what.contains("unpacks to more than 64 MiB"));
}

#[test]
fn a_workbook_is_looked_into_without_a_test() {
    let rows = "<row r=\"3\"><c r=\"A3\" t=\"inlineStr\"><is><t>Time (ms)</t></is></c><c r=\"B3\" t=\"inlineStr\"><is><t>Reading (mm)</t></is></c></row>\
        <row r=\"4\"><c r=\"A4\"><v>0</v></c><c r=\"B4\"><v>0.5</v></c></row><row r=\"5\"><c r=\"A5\"><v>40</v></c><c r=\"B5\"><v>-0.25</v></c></row>";
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("run.xlsx");
    std::fs::write(&file, workbook(&[("Run 1", rows)])).unwrap();
    let Content::Table(table) = look_into(&file, None).unwrap() else { panic!("no table") };
    assert_eq!(table.layout.written, Written::Sheet("Run 1".into()));
    assert_eq!((table.layout.header_line, table.log.sample_period_s()), (3, 0.04));
    assert_eq!(table.log.readings()[1].deviation_mm, Some(-0.25));
}
