//! Fonts for languages whose letters egui's own fonts lack: a small bundled font for the texts of the interface, and a
//! font of the system, if there is one, for any other text that may be typed.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::{Context, FontData, FontDefinitions, FontFamily};

/// Bundled fonts with the letters of the interface's texts, cut out of Noto Sans CJK (SIL Open Font License 1.1) by
/// `assets/languages/fonts.py`.
const JAPANESE: &[u8] = include_bytes!("../../../assets/languages/ja.otf");
const CHINESE: &[u8] = include_bytes!("../../../assets/languages/zh.otf");
/// Bundled font with the letters of the languages' own names.
const NAMES: &[u8] = include_bytes!("../../../assets/languages/names.otf");

/// Complete fonts of common systems, each with the face of the file: first those with Japanese forms, then with Chinese
/// ones.
const OF_JAPANESE: [(&str, u32); 6] = [
    ("/usr/share/fonts/opentype/noto/NotoSansCJK-Regular.ttc", 0),
    ("/usr/share/fonts/noto-cjk/NotoSansCJK-Regular.ttc", 0),
    ("/usr/share/fonts/google-noto-cjk/NotoSansCJK-Regular.ttc", 0),
    ("/System/Library/Fonts/ヒラギノ角ゴシック W3.ttc", 0),
    ("C:/Windows/Fonts/YuGothR.ttc", 0),
    ("C:/Windows/Fonts/msgothic.ttc", 0),
];
const OF_CHINESE: [(&str, u32); 7] = [
    ("/usr/share/fonts/opentype/noto/NotoSansCJK-Regular.ttc", 2),
    ("/usr/share/fonts/noto-cjk/NotoSansCJK-Regular.ttc", 2),
    ("/usr/share/fonts/google-noto-cjk/NotoSansCJK-Regular.ttc", 2),
    ("/usr/share/fonts/truetype/wqy/wqy-microhei.ttc", 0),
    ("/System/Library/Fonts/PingFang.ttc", 2),
    ("/System/Library/Fonts/STHeiti Light.ttc", 0),
    ("C:/Windows/Fonts/msyh.ttc", 0),
];
/// The largest font that is read, bytes.
const LARGEST: u64 = 128 << 20;

/// Uses the fonts that a language needs, by its code.
pub fn apply(ctx: &Context, code: &str) {
    ctx.set_fonts(definitions(code, true));
}

/// The fonts of a language, with or without a font of the system.
fn definitions(code: &str, system_too: bool) -> FontDefinitions {
    let mut fonts = FontDefinitions::default();
    let needs = match code {
        "ja" => Some((JAPANESE, &OF_JAPANESE[..])),
        "zh" => Some((CHINESE, &OF_CHINESE[..])),
        _ => None,
    };
    if needs.is_none() {
        add(&mut fonts, "names of languages", FontData::from_static(NAMES));
    }
    if let Some((small, system)) = needs {
        add(
            &mut fonts,
            "letters of the interface",
            FontData::from_static(small),
        );
        let mut system = system.iter().filter(|_| system_too);
        if let Some(font) = system.find_map(|(path, face)| read(Path::new(path), *face)) {
            add(&mut fonts, "letters of the system", font);
        }
    }
    fonts
}

/// Adds a font behind the existing ones.
fn add(fonts: &mut FontDefinitions, name: &str, font: FontData) {
    fonts.font_data.insert(name.into(), Arc::new(font));
    for family in [FontFamily::Proportional, FontFamily::Monospace] {
        fonts.families.entry(family).or_default().push(name.into());
    }
}

fn read(path: &Path, face: u32) -> Option<FontData> {
    let path = PathBuf::from(path);
    let fits = std::fs::metadata(&path).is_ok_and(|m| m.is_file() && m.len() <= LARGEST);
    let bytes = fits.then(|| std::fs::read(&path).ok()).flatten()?;
    let mut font = FontData::from_owned(bytes);
    font.index = face;
    Some(font)
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::FontId;

    /// A translation with a letter that its font lacks: run `assets/languages/fonts.py`.
    #[test]
    fn every_letter_of_the_interface_has_a_shape() {
        for language in language::all() {
            let ctx = Context::default();
            ctx.set_fonts(definitions(&language.code, false));
            let _ = ctx.run_ui(Default::default(), |_| {});
            let texts = language.texts().map(|(_, own)| own).chain([&*language.name]);
            let letters: std::collections::BTreeSet<char> = texts.flat_map(str::chars).collect();
            let font = FontId::proportional(14.0);
            let lacks = ctx.fonts_mut(|fonts| {
                let lacks = letters
                    .iter()
                    .filter(|c| !c.is_control() && !fonts.has_glyph(&font, **c));
                lacks.collect::<String>()
            });
            assert_eq!(lacks, "", "{}", language.code);
        }
    }

    /// A character that no font has would be drawn as an empty square; an icon has to be used instead.
    #[test]
    fn every_sign_that_is_drawn_has_a_shape() {
        let ctx = Context::default();
        ctx.set_fonts(definitions("en", false));
        let _ = ctx.run_ui(Default::default(), |_| {});
        let app = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let drawing = ["panes", "windows", "widgets", "tools", "shell"].map(|folder| app.join(folder));
        let mut signs = std::collections::BTreeMap::<char, PathBuf>::new();
        for file in drawing.iter().flat_map(|folder| rust_files(folder)) {
            let text = std::fs::read_to_string(&file).expect("source");
            let program = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or("");
            let lines = program.lines().filter(|l| !l.trim_start().starts_with("//"));
            // Characters of other scripts are words that the parser understands, or names of fonts.
            let drawn = lines
                .flat_map(str::chars)
                .filter(|c| !c.is_ascii() && *c < '\u{2e80}' && *c != IN_THE_TITLE);
            for c in drawn {
                signs.entry(c).or_insert_with(|| file.clone());
            }
        }
        assert!(signs.contains_key(&'…'), "{signs:?}");
        let font = FontId::proportional(14.0);
        ctx.fonts_mut(|fonts| signs.retain(|c, _| !fonts.has_glyph(&font, *c)));
        assert!(signs.is_empty(), "{signs:?}");
    }

    /// Mark of an unsaved scene in the window's title, which the system draws.
    const IN_THE_TITLE: char = '●';

    fn rust_files(folder: &Path) -> Vec<PathBuf> {
        let entries = std::fs::read_dir(folder).expect("a folder").flatten();
        let of = |path: PathBuf| match path.is_dir() {
            true => rust_files(&path),
            false => vec![path],
        };
        let all = entries.flat_map(|e| of(e.path()));
        all.filter(|p| p.extension().is_some_and(|e| e == "rs")).collect()
    }
}
