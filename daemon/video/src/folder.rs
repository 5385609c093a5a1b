//! Folders of pictures. The numbers in their names are their order and their times: a number that is missing is a picture that is missing.

use std::path::{Path, PathBuf};

use andon_host::video::pipe::PictureFormat;
use andon_learn::file;
use opencv::core::{Mat, MatTraitConst, MatTraitConstManual as _, Vector};
use opencv::imgcodecs;

use crate::source::Source;
use crate::whole::is_cut;

/// The endings of pictures that are read.
const PICTURES: [&str; 6] = ["png", "jpg", "jpeg", "bmp", "tif", "tiff"];

/// What to do about names that say no order.
const REMEDY: &str = "name the pictures of one recording alike, with one number that counts them, as `ffmpeg -i FILM %06d.png` does";

/// Whether a file has the ending of a picture that is read.
pub(crate) fn is_picture(path: &Path) -> bool {
    let ending = path.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase);
    ending.is_some_and(|ending| PICTURES.contains(&ending.as_str()))
}

/// A folder of pictures, or a single one.
pub(crate) struct Folder {
    /// Each with its number since the first.
    pictures: Vec<(u64, PathBuf)>,
    format: PictureFormat,
    shown: usize,
}

impl Folder {
    /// Opens all pictures of a folder, to be played at `rate_hz`.
    ///
    /// # Errors
    /// A message for a technician: what is wrong with which picture.
    pub(crate) fn open(path: &Path, rate_hz: f64) -> Result<Self, String> {
        let listed = std::fs::read_dir(path).and_then(|entries| {
            entries.map(|entry| entry.map(|entry| entry.path())).collect::<std::io::Result<Vec<_>>>()
        });
        let mut pictures = listed.map_err(|error| error.to_string())?;
        pictures.retain(|path| is_picture(path));
        Self::of(numbered(pictures)?, rate_hz)
    }

    /// Opens a single picture.
    ///
    /// # Errors
    /// As [`Folder::open`].
    pub(crate) fn of_one(path: &Path, rate_hz: f64) -> Result<Self, String> {
        Self::of(vec![(0, path.to_owned())], rate_hz)
    }

    fn of(pictures: Vec<(u64, PathBuf)>, rate_hz: f64) -> Result<Self, String> {
        let (_, first) = pictures.first().ok_or("the folder holds no picture (png, jpg, bmp, tif)")?;
        let (width, height) = {
            let mat = decode(first)?;
            (mat.cols() as u32, mat.rows() as u32)
        };
        let format = PictureFormat { width, height, rate_hz, count: pictures.len() as u64 };
        Ok(Self { pictures, format, shown: 0 })
    }
}

/// A name, taken apart at the digits in it.
struct Name {
    path: PathBuf,
    /// What stands between the numbers.
    words: Vec<String>,
    /// The digits of each number.
    numbers: Vec<String>,
}

impl Name {
    fn of(path: PathBuf) -> Self {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let (mut words, mut numbers) = (vec![String::new()], Vec::new());
        let mut in_number = false;
        for letter in stem.chars() {
            match (letter.is_ascii_digit(), in_number) {
                (true, false) => numbers.push(letter.to_string()),
                (true, true) => {
                    numbers.last_mut().into_iter().for_each(|number: &mut String| number.push(letter))
                }
                (false, true) => words.push(letter.to_string()),
                (false, false) => words.last_mut().into_iter().for_each(|word| word.push(letter)),
            }
            in_number = letter.is_ascii_digit();
        }
        Self { path, words, numbers }
    }

    fn shown(&self) -> String {
        self.path.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }
}

/// The pictures in the order of the one number in which their names differ, with it since the first.
fn numbered(paths: Vec<PathBuf>) -> Result<Vec<(u64, PathBuf)>, String> {
    let mut names: Vec<Name> = paths.into_iter().map(Name::of).collect();
    names.sort_by(|one, other| one.path.cmp(&other.path));
    let Some((first, others)) = names.split_first() else { return Ok(Vec::new()) };
    if others.is_empty() {
        return Ok(vec![(0, first.path.clone())]);
    }
    let unlike = |name: &&Name| name.words != first.words || name.numbers.len() != first.numbers.len();
    if let Some(other) = others.iter().find(unlike) {
        return Err(format!("{} and {} are not named alike; {REMEDY}", first.shown(), other.shown()));
    }
    let differs = |at: &usize| others.iter().any(|name| name.numbers[*at] != first.numbers[*at]);
    let differing: Vec<usize> = (0..first.numbers.len()).filter(differs).collect();
    // Names that do not differ are those of one picture in two formats.
    let &[at] = differing.as_slice() else {
        let why = if differing.is_empty() { "say no order" } else { "differ in more than one number" };
        return Err(format!("{} and {} {why}; {REMEDY}", first.shown(), others[others.len() - 1].shown()));
    };
    let mut numbered = Vec::with_capacity(names.len());
    for name in &names {
        let number: u64 = name.numbers[at]
            .parse()
            .map_err(|_| format!("the number in {} is too large; {REMEDY}", name.shown()))?;
        numbered.push((number, name));
    }
    numbered.sort_by_key(|(number, _)| *number);
    if let Some(pair) = numbered.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        return Err(format!("{} and {} have one number; {REMEDY}", pair[0].1.shown(), pair[1].1.shown()));
    }
    if let Some(step) = numbered.windows(2).map(|pair| pair[1].0 - pair[0].0).min().filter(|step| *step > 1) {
        return Err(format!(
            "the numbers of the pictures are never less than {step} apart, so they count no pictures, or others were taken away; {REMEDY}"
        ));
    }
    let begin = numbered[0].0;
    Ok(numbered.into_iter().map(|(number, name)| (number - begin, name.path.clone())).collect())
}

fn decode(path: &Path) -> Result<Mat, String> {
    let failed = |message: &dyn std::fmt::Display| format!("{}: {message}", path.display());
    let bytes = file::read(path).map_err(|error| failed(&error))?;
    if bytes.is_empty() {
        return Err(failed(&"the file is empty: copy the picture again"));
    }
    if is_cut(&bytes) {
        return Err(failed(&"the picture is cut off before its end: copy it again"));
    }
    let bytes: Vector<u8> = bytes.into();
    let mat = imgcodecs::imdecode(&bytes, imgcodecs::IMREAD_COLOR).map_err(|error| failed(&error))?;
    if mat.empty() { Err(failed(&"not a picture that can be read")) } else { Ok(mat) }
}

impl Source for Folder {
    fn format(&self) -> PictureFormat {
        self.format
    }

    fn next_picture(&mut self, picture: &mut [u8]) -> Result<Option<u64>, String> {
        let Some((number, path)) = self.pictures.get(self.shown) else { return Ok(None) };
        let mat = decode(path)?;
        let bytes = mat.data_bytes().map_err(|error| error.to_string())?;
        if bytes.len() != picture.len() || mat.cols() as u32 != self.format.width {
            return Err(format!(
                "{}: {} x {} pixels, but the first picture of the folder has {} x {}",
                path.display(),
                mat.cols(),
                mat.rows(),
                self.format.width,
                self.format.height
            ));
        }
        picture.copy_from_slice(bytes);
        let pts_ns = (*number as f64 * 1e9 / self.format.rate_hz).round() as u64;
        self.shown += 1;
        Ok(Some(pts_ns))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn ordered(names: &[&str]) -> Result<Vec<(u64, String)>, String> {
        let numbered = numbered(names.iter().map(PathBuf::from).collect())?;
        Ok(numbered.into_iter().map(|(number, path)| (number, path.to_str().unwrap().to_owned())).collect())
    }

    fn numbers(names: &[&str]) -> Vec<u64> {
        ordered(names).unwrap().into_iter().map(|(number, _)| number).collect()
    }

    #[test]
    fn pictures_come_in_the_order_of_their_numbers_however_these_are_written() {
        let names = ["f_1.jpg", "f_10.jpg", "f_2.jpg", "f_9.jpg", "f_11.jpg"];
        let sorted: Vec<String> = ordered(&names).unwrap().into_iter().map(|(_, name)| name).collect();
        assert_eq!(sorted, ["f_1.jpg", "f_2.jpg", "f_9.jpg", "f_10.jpg", "f_11.jpg"]);
        assert_eq!(numbers(&["99.png", "100.png", "01.png", "02.png"]), [0, 1, 98, 99], "as of %02d");
        assert_eq!(
            numbers(&["cam1_0007.png", "cam1_0008.jpg"]),
            [0, 1],
            "what is the same in all says nothing"
        );
    }

    #[test]
    fn a_number_that_is_missing_is_a_picture_that_is_missing() {
        assert_eq!(numbers(&["0139.jpg", "0140.jpg", "0176.jpg", "0177.jpg"]), [0, 1, 37, 38]);
    }

    #[test]
    fn what_says_no_order_is_refused_with_the_names_and_the_remedy() {
        for (names, said) in [
            (&["a.png", "b.png"][..], "a.png and b.png are not named alike"),
            (&["left_1.png", "right_1.png"], "left_1.png and right_1.png are not named alike"),
            (&["1.png", "01.png", "2.png"], "01.png and 1.png have one number"),
            (&["1.png", "1.jpg"], "1.jpg and 1.png say no order"),
            (&["10-15-00.png", "10-15-01.png", "10-16-00.png"], "differ in more than one number"),
            (&["0.png", "33.png", "66.png"], "never less than 33 apart"),
            (&["99999999999999999999999.png", "1.png"], "too large"),
        ] {
            let refused = ordered(names).unwrap_err();
            assert!(refused.contains(said) && refused.contains("%06d"), "{names:?}: {refused}");
        }
        assert_eq!(numbers(&["bench.png"]), [0], "one picture needs no number");
    }
}
