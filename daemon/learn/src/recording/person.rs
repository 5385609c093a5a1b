//! Who is recorded, by the name of the recording.

/// The words before the number of a person in the name of a recording, such as `p3_none_r1` or `subject3_run1`.
const PERSON: [&str; 4] = ["person", "subject", "worker", "p"];

/// The number of the person whom the name of a recording begins with.
pub fn person_of(file: &str) -> Option<u32> {
    let (person, _) = file.split_once('_')?;
    PERSON.iter().find_map(|word| person.strip_prefix(word)?.parse().ok())
}
