//! Exported files of a figure with known geometry.

use std::io::{Cursor, Read};

use flate2::read::ZlibDecoder;
use roxmltree::{Document, Node};

use super::*;

fn number(node: Node<'_, '_>, name: &str) -> f64 {
    node.attribute(name).unwrap().parse().unwrap()
}

/// Returns left, top, width and height of the only frame.
fn frame(document: &Document<'_>) -> [f64; 4] {
    let clip = document
        .descendants()
        .find(|node| node.has_tag_name("clipPath"))
        .unwrap();
    ["x", "y", "width", "height"].map(|name| number(clip.first_element_child().unwrap(), name))
}

fn points(path: &str) -> Vec<[f64; 2]> {
    let numbers: Vec<f64> = path
        .split(['M', 'L', 'Z', ' '])
        .filter(|word| !word.is_empty())
        .map(|word| word.parse().unwrap())
        .collect();
    numbers.chunks(2).map(|pair| [pair[0], pair[1]]).collect()
}

#[test]
fn a_diagonal_curve_in_an_svg_file_runs_from_corner_to_corner_of_the_frame() {
    let text = svg(&diagonal());
    let document = Document::parse(&text).unwrap();
    let [left, top, width, height] = frame(&document);
    // The colour of the curve, `Hue::Nominal`.
    let curve = document
        .descendants()
        .find(|node| node.attribute("stroke") == Some("#c62f2f"))
        .unwrap();
    let ends = points(curve.attribute("d").unwrap());
    assert_eq!(ends.len(), 2);
    // Coordinates are written with a resolution of 0.01 pt.
    for (at, expected) in ends.iter().zip([[left, top + height], [left + width, top]]) {
        assert!(
            (at[0] - expected[0]).abs() < 0.011 && (at[1] - expected[1]).abs() < 0.011,
            "the curve has an end at {at:?}, expected {expected:?}"
        );
    }
}

#[test]
fn an_svg_file_has_the_width_of_the_column_and_text_elements_of_at_least_7_pt() {
    for width in ColumnWidth::BOTH {
        let text = String::from_utf8(bytes(&diagonal(), width, FigureFormat::Svg)).unwrap();
        let document = Document::parse(&text).unwrap();
        let root = document.root_element();
        assert_eq!(
            root.attribute("width"),
            Some(format!("{}mm", width.mm()).as_str())
        );
        let words: Vec<&str> = document
            .descendants()
            .filter(|node| node.has_tag_name("text"))
            .filter_map(|node| node.text())
            .collect();
        for expected in [
            "A line & <its> frame → Δφ",
            "LON → Q",
            "Frequency [rad/s]",
            "Magnitude [dB]",
            "rising",
            "10",
            "−4",
        ] {
            assert!(
                words.contains(&expected),
                "{expected} is missing in {words:?}"
            );
        }
        let sizes = document
            .descendants()
            .filter_map(|node| node.attribute("font-size"))
            .map(|size| size.parse::<f64>());
        assert!(
            sizes.map(Result::unwrap).all(|size| size >= 7.0),
            "a text is smaller than 7 pt, the minimum of journals"
        );
    }
}

#[test]
fn the_texts_of_every_figure_lie_within_the_page() {
    let example = &*EXAMPLE;
    for kind in FigureKind::ALL {
        let figure = example.figure(kind, example.on_axis());
        for width in ColumnWidth::BOTH {
            let drawing = figure.drawing(width);
            let texts = drawing.shapes.iter().filter_map(|shape| match shape {
                gdcm_plot::figure::drawing::Shape::Text(text) if !text.upright => Some(text),
                _ => None,
            });
            for text in texts {
                let length = gdcm_plot::figure::layout::width(&text.words) * text.size_pt;
                let from = text.at[0] - text.anchor.before() * length;
                let is_within = from >= -0.5 && from + length <= drawing.size[0] + 0.5;
                assert!(
                    is_within && (0.0..=drawing.size[1]).contains(&text.at[1]),
                    "{kind:?} {width:?} {text:?}"
                );
            }
        }
    }
}

/// Returns width, height and the colours of a PNG's pixels, row by row.
fn decoded(bytes: &[u8]) -> (usize, usize, Vec<[u8; 3]>) {
    let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().unwrap();
    let dots = reader.info().pixel_dims.unwrap();
    // 300 dpi are 11 811 pixels per metre.
    assert_eq!((dots.xppu, dots.yppu), (11811, 11811));
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    (
        info.width as usize,
        info.height as usize,
        pixels
            .chunks(3)
            .map(|rgb| [rgb[0], rgb[1], rgb[2]])
            .collect(),
    )
}

#[test]
fn a_png_file_has_300_dpi_and_the_colour_of_the_curve_on_the_diagonal() {
    let (width, height, colors) =
        decoded(&bytes(&diagonal(), ColumnWidth::Single, FigureFormat::Png));
    let text =
        String::from_utf8(bytes(&diagonal(), ColumnWidth::Single, FigureFormat::Svg)).unwrap();
    let document = Document::parse(&text).unwrap();
    // A single column is 84 mm wide.
    assert_eq!(width, (84.0_f64 / 25.4 * 300.0).ceil() as usize);
    let view: Vec<f64> = document
        .root_element()
        .attribute("viewBox")
        .unwrap()
        .split(' ')
        .map(|word| word.parse().unwrap())
        .collect();
    assert!((height as f64 - view[3] * 300.0 / 72.0).abs() < 1.1);
    let [left, top, frame_width, frame_height] = frame(&document);
    // Positions in points, 72 to the inch.
    let color_at =
        |x: f64, y: f64| colors[(y * 300.0 / 72.0) as usize * width + (x * 300.0 / 72.0) as usize];
    // A point at a tenth of the diagonal, at the centre of the line of 3 pt; then a point of the
    // background away from it.
    assert_eq!(
        color_at(left + 0.1 * frame_width, top + 0.9 * frame_height),
        [0xc6, 0x2f, 0x2f]
    );
    assert_eq!(
        color_at(left + 0.13 * frame_width, top + 0.33 * frame_height),
        [255, 255, 255]
    );
    assert_eq!(colors[0], [255, 255, 255]);
    // The title has been drawn: there are dark pixels above the frame.
    let title = &colors[..width * (top * 300.0 / 72.0) as usize];
    assert!(title.iter().filter(|color| color[0] < 0x60).count() > 200);
}

/// Returns the decompressed streams of a PDF.
fn streams(pdf: &[u8]) -> Vec<Vec<u8>> {
    let find = |from: usize, word: &[u8]| {
        pdf[from..]
            .windows(word.len())
            .position(|window| window == word)
            .map(|at| from + at)
    };
    let mut streams = Vec::new();
    let mut from = 0;
    while let Some(start) = find(from, b"stream\n") {
        let end = find(start, b"endstream").unwrap();
        let mut unpacked = Vec::new();
        ZlibDecoder::new(&pdf[start + 7..end])
            .read_to_end(&mut unpacked)
            .unwrap();
        streams.push(unpacked);
        from = end + 9;
    }
    streams
}

#[test]
fn a_pdf_file_embeds_its_fonts_and_maps_glyphs_to_characters() {
    let pdf = bytes(&diagonal(), ColumnWidth::Single, FigureFormat::Pdf);
    assert!(pdf.starts_with(b"%PDF-1."));
    assert!(pdf.ends_with(b"%%EOF"));
    let text = String::from_utf8_lossy(&pdf).into_owned();
    for word in [
        // 84 mm, the width of a single column.
        "/MediaBox [0 0 238.11",
        "/Subtype /CIDFontType2",
        "/FontFile2",
        "/ToUnicode",
        "GDCMFG+Ubuntu",
        "GDCMFG+Hack",
    ] {
        assert!(text.contains(word), "{word}");
    }
    for word in ["/CreationDate", "/ModDate", "/ID"] {
        assert!(
            !text.contains(word),
            "{word} differs from one file to the next"
        );
    }
    let streams = streams(&pdf);
    let content = String::from_utf8_lossy(&streams[0]).into_owned();
    assert!(
        content.contains("BT") && content.contains(" Tf") && content.contains(" Tj"),
        "the page should contain text operators"
    );
    let maps: Vec<String> = streams
        .iter()
        .map(|stream| String::from_utf8_lossy(stream).into_owned())
        .collect();
    for character in ['Δ', 'φ', '→', 'L', '−'] {
        let code = format!("<{:04X}>", u32::from(character));
        assert!(
            maps.iter()
                .any(|map| map.contains("begincmap") && map.contains(&code)),
            "no character map contains {character}"
        );
    }
}

#[test]
fn the_same_figure_gives_the_same_bytes() {
    for format in FigureFormat::ALL {
        let once = bytes(&diagonal(), ColumnWidth::Double, format);
        assert_eq!(
            once,
            bytes(&diagonal(), ColumnWidth::Double, format),
            "{format:?}"
        );
        assert!(!once.is_empty());
    }
}

#[test]
fn characters_that_xml_forbids_are_escaped_or_removed() {
    let figure = Figure::new("a\u{1}b\u{fffe}c\"<&>").plot(diagonal().plots.remove(0));
    let text = svg(&figure);
    let document = Document::parse(&text).unwrap();
    let title = document
        .descendants()
        .find(|node| node.has_tag_name("title"))
        .unwrap();
    assert_eq!(title.text(), Some("a\\u{1}bc\"<&>"));
}
