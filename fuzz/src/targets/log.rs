//! Logs, in every format that a test file can name.

use ballbar::log::{
    Delimiter, Format, LengthUnit, ReadingColumn, ReadingKind, TimeColumn, TimeUnit, read_bytes,
};

use super::{Target, accepted};
use crate::mutate::gzipped;
use crate::seeds;

pub const TARGET: Target = Target {
    name: "log",
    seeds: || {
        let texts = [
            "time_s,deviation_um\n0.0,\n0.1,6.3\n0.2,-5\n0.3,+1e2\n",
            "# a comment\ntime_s;deviation_um\n0,0;\n0,1;6,3\n0,2;-5,0\n",
            "time_s\tdeviation_um\tother\n0.0\t\tx\n0.1\t6.3\t\n0.2\t-5\t3\n",
            "deviation_um\n1\n\n2.5\n-3\n\n",
            "angle_deg,deviation_um\n350,1\n355,2\n0,3\n355,4\n350,5\n",
            "t_ms,length_mm\n0,150.1\n10,150.2\n20,149.9\n",
            "\u{feff}time_s,deviation_um\r\n0.0,1\r\n0.1,2\r\n",
            "sep=;\r\nlog of a bar\r\ntime_s;deviation_um\r\n08:00:00,0;OVER\r\n08:00:00,1;2\r\n",
            "time_s deviation_um\r59:59.9 9999.9\r00:00.1 \u{2212}2\r\u{1a}",
            "time_s,deviation_um\n2026-11-23T23:59:59Z,---\n2026-11-24T00:00:00Z,\"6,3\"\n",
        ];
        let mut seeds: Vec<Vec<u8>> = texts.map(|text| text.as_bytes().to_vec()).into();
        seeds.push(texts[0].encode_utf16().flat_map(u16::to_le_bytes).collect());
        for packed in seeds::all_of_project("tests/data", ".csv.gz").iter().take(6) {
            let mut plain = Vec::new();
            let unpacked = std::io::Read::read_to_end(
                &mut flate2::read::GzDecoder::new(&packed[..]),
                &mut plain,
            );
            // Their beginning and what the bar reads first.
            let lines: Vec<&[u8]> = plain.split_inclusive(|byte| *byte == b'\n').collect();
            if unpacked.is_ok() {
                seeds.push(lines[..lines.len().min(400)].concat());
            }
        }
        seeds
    },
    words: &[
        "time_s",
        "deviation_um",
        "t_ms",
        "length_mm",
        "#",
        ",",
        ";",
        "\t",
        "0.1,",
        "1,5",
        "nan",
        "inf",
        "-inf",
        "1e3",
        "1E-3",
        "+1",
        "PM",
        "23:59:59.9",
        "sep=",
        "NaN",
    ],
    made: &[
        // A column of nothing but line ends, packed small: two bytes a reading of 24.
        || gzipped(&[b"deviation_um\n1\n".to_vec(), vec![b'\n'; 100_000_000]].concat()),
        || gzipped(&vec![b'\n'; 300_000_000]),
        || gzipped(&gzipped(&vec![b'0'; 300_000_000])),
        || [b"time_s,deviation_um\n".to_vec(), vec![b','; 20_000_000]].concat(),
    ],
    read,
};

fn column(name: &str, unit: LengthUnit, kind: ReadingKind, inverted: bool) -> ReadingColumn {
    ReadingColumn { name: name.to_owned(), unit, kind, inverted }
}

fn read(input: &[u8]) -> bool {
    let default = Format::default();
    let long = ReadingKind::Length { nominal_mm: 150.0 };
    let formats = [
        Format {
            time: TimeColumn::Rate { hz: 10.0 },
            reading: column("deviation_um", LengthUnit::Micrometre, ReadingKind::Deviation, true),
            ..Format::default()
        },
        Format {
            time: TimeColumn::Named { name: "t_ms".into(), unit: TimeUnit::Millisecond },
            reading: column("length_mm", LengthUnit::Millimetre, long, false),
            delimiter: Some(Delimiter::Comma),
            ..Format::default()
        },
    ];
    let formats = formats.into_iter().chain([
        // A table of angles.
        Format {
            time: TimeColumn::Angle { name: "angle_deg".into() },
            plane: Some([2, 0]),
            ..Format::default()
        },
    ]);
    let mut taken = false;
    // Where the first does not know the columns, another may.
    for format in std::iter::once(default).chain(formats) {
        let log = read_bytes(input, "run.csv".as_ref(), &format);
        if let Ok(log) = &log {
            let readings = log.readings();
            assert!(readings.len() > 1, "a log has two readings");
            assert!(
                readings.windows(2).all(|pair| pair[0].time_s < pair[1].time_s),
                "times increase"
            );
            assert!(
                readings
                    .iter()
                    .all(|r| r.time_s.is_finite() && r.deviation_mm.is_none_or(f64::is_finite))
            );
            let _ = log.in_range_intervals();
        }
        taken |= accepted(&log);
        if taken || input.len() > 1 << 20 {
            break;
        }
    }
    taken
}
