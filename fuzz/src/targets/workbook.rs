//! Workbooks: an archive with a wrong byte fails its checksum, so that the parts are changed before they are packed.

use std::io::{Cursor, Write as _};

use ballbar::log::{Format, read_bytes};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::{Target, accepted};
use crate::seeds::BETWEEN;

/// The parts of an input, in their order.
const PARTS: [&str; 6] = [
    "xl/worksheets/sheet1.xml",
    "xl/workbook.xml",
    "xl/_rels/workbook.xml.rels",
    "xl/styles.xml",
    "xl/sharedStrings.xml",
    "_rels/.rels",
];

const SEED: [&str; 6] = [
    "<worksheet><dimension ref=\"A1:B4\"/><sheetData><row r=\"1\"><c r=\"A1\" t=\"s\"><v>0</v></c><c r=\"B1\" t=\"s\"><v>1</v></c></row>\
     <row r=\"2\"><c r=\"A2\" s=\"1\"><v>46349.5</v></c><c r=\"B2\"><f t=\"shared\" ref=\"B2:B3\" si=\"0\">A2*2</f><v>6.3</v></c></row>\
     <row r=\"3\"><c r=\"A3\" s=\"1\"><v>46349.6</v></c><c r=\"B3\" t=\"str\"><f t=\"shared\" si=\"0\"/><v>OVER</v></c></row>\
     <row r=\"4\"><c r=\"A4\" s=\"1\" t=\"n\"><v>46349.7</v></c><c r=\"B4\" t=\"e\"><v>#N/A</v></c><c t=\"b\"><v>1</v></c></row>\
     <row r=\"5\"><c s=\"1\"><v>46349.8</v></c><c><v>-1.5</v></c><c t=\"inlineStr\"><is><r><t>x</t></r></is></c>\
     <c t=\"d\"><v>2026-11-23</v></c></row></sheetData></worksheet>",
    "<workbook xmlns:r=\"http://schemas.openxmlformats.org/officeDocument/2006/relationships\"><workbookPr date1904=\"0\"/>\
     <sheets><sheet name=\"Log\" sheetId=\"1\" r:id=\"rId1\"/></sheets><definedNames/></workbook>",
    "<Relationships><Relationship Id=\"rId1\" Type=\"http://schemas.openxmlformats.org/officeDocument/2006/relationships/worksheet\" \
     Target=\"worksheets/sheet1.xml\"/></Relationships>",
    "<styleSheet><numFmts count=\"1\"><numFmt numFmtId=\"164\" formatCode=\"hh:mm:ss.000\"/></numFmts>\
     <cellXfs count=\"2\"><xf numFmtId=\"0\"/><xf numFmtId=\"164\"/></cellXfs></styleSheet>",
    "<sst count=\"2\" uniqueCount=\"2\"><si><t>time_s</t></si><si><t>deviation_um</t></si></sst>",
    "<Relationships><Relationship Id=\"rId1\" \
     Type=\"http://schemas.openxmlformats.org/officeDocument/2006/relationships/officeDocument\" Target=\"xl/workbook.xml\"/></Relationships>",
];

pub const TARGET: Target = Target {
    name: "workbook",
    seeds: || {
        let parts = SEED.map(str::as_bytes);
        vec![parts.join(BETWEEN)]
    },
    words: &[
        "<c r=\"A2\">",
        "<c/>",
        "<v>",
        "</v>",
        "<f>",
        "t=\"n\"",
        "t=\"s\"",
        "+1",
        "1e999",
        "-1",
        "NaN",
        "XFD1048576",
        "A0",
        "si=\"99999999999\"",
        "<row r=\"4294967295\">",
        "&amp;",
        "&x;",
        "<!DOCTYPE x [<!ENTITY x \"xxxx\">]>",
    ],
    made: &[],
    read,
};

fn packed(parts: &[&[u8]]) -> Option<Vec<u8>> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    for (name, part) in PARTS.iter().zip(parts) {
        archive.start_file(*name, options).ok()?;
        archive.write_all(part).ok()?;
    }
    Some(archive.finish().ok()?.into_inner())
}

fn read(input: &[u8]) -> bool {
    let mut parts = Vec::new();
    let mut rest = input;
    while let Some(at) = rest.windows(BETWEEN.len()).position(|window| window == BETWEEN) {
        parts.push(&rest[..at]);
        rest = &rest[at + BETWEEN.len()..];
    }
    parts.push(rest);
    let Some(bytes) = packed(&parts) else { return false };
    let log = read_bytes(&bytes, "run.xlsx".as_ref(), &Format::default());
    if let Ok(log) = &log {
        let readings = log.readings();
        assert!(readings.windows(2).all(|pair| pair[0].time_s < pair[1].time_s), "times increase");
        assert!(readings.iter().all(|r| r.deviation_mm.is_none_or(f64::is_finite)));
    }
    accepted(&log)
}
