//! The journal as CSV with one column more than the journal has: the recording of each verdict, as it lies on the disk now. It stands before the part,
//! which stays the last, because it is the text of people.

use std::collections::HashMap;
use std::io::{self, Write};

use andon_record::store::Recording;
use shm_schemas::MessageId;

/// Writes lines of CSV with the recording in each.
pub(super) struct WithClips<'c, W> {
    out: W,
    clips: &'c HashMap<MessageId, &'c Recording>,
    columns: Option<Columns>,
    line: Vec<u8>,
}

/// Where these stand in a line, as the first one says.
#[derive(Clone, Copy)]
struct Columns {
    entry: usize,
    epoch: usize,
    seq: usize,
    part: usize,
}

impl<'c, W: Write> WithClips<'c, W> {
    pub(super) fn new(out: W, clips: &'c HashMap<MessageId, &'c Recording>) -> Self {
        Self { out, clips, columns: None, line: Vec::new() }
    }

    fn write_line(&mut self, line: &str) -> io::Result<()> {
        let Some(columns) = self.columns else {
            let place = |name: &str| line.split(',').position(|field| field == name).unwrap_or_default();
            let [entry, epoch, seq, part] = ["entry", "epoch", "seq", "part"].map(place);
            self.columns = Some(Columns { entry, epoch, seq, part });
            return self.insert(line, part, "clip");
        };
        let fields: Vec<&str> = line.splitn(columns.part + 1, ',').collect();
        self.insert(line, columns.part, &self.clip(&fields, columns))
    }

    fn insert(&mut self, line: &str, before: usize, field: &str) -> io::Result<()> {
        let mut fields: Vec<&str> = line.splitn(before + 1, ',').collect();
        fields.insert(before.min(fields.len()), field);
        write!(self.out, "{}\r\n", fields.join(","))
    }

    /// A gap begins with the number that a verdict would have had, and has no recording.
    fn clip(&self, fields: &[&str], columns: Columns) -> String {
        let number = |column: usize| fields.get(column).and_then(|field| field.parse().ok());
        let id = || Some(MessageId { epoch: number(columns.epoch)?, seq: number(columns.seq)? });
        let is_verdict = fields.get(columns.entry) == Some(&"verdict");
        let recording = is_verdict.then(id).flatten().and_then(|id| self.clips.get(&id));
        recording.map_or_else(String::new, |recording| quoted(recording.path.display().to_string()))
    }
}

fn quoted(text: String) -> String {
    let is_plain = !text.contains([',', '"']);
    if is_plain { text } else { format!("\"{}\"", text.replace('"', "\"\"")) }
}

impl<W: Write> Write for WithClips<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.line.extend_from_slice(bytes);
        while let Some(end) = self.line.windows(2).position(|two| two == b"\r\n") {
            let line: Vec<u8> = self.line.drain(..end + 2).take(end).collect();
            self.write_line(&String::from_utf8_lossy(&line))?;
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use andon_record::index::Index;

    #[test]
    fn each_verdict_has_its_recording_and_a_gap_has_none() {
        let recording = |path: &str| Recording { path: path.into(), index: Index::default() };
        let (plain, odd) = (recording("/a/b.mcap"), recording("/a,\"b\".mcap"));
        let id = |seq| MessageId { epoch: 7, seq };
        let clips = HashMap::from([(id(1), &plain), (id(3), &odd)]);
        let mut out = Vec::new();
        let mut csv = WithClips::new(&mut out, &clips);
        let text =
            "entry,epoch,seq,part\r\nverdict,7,1,\"a,b\"\r\nverdict,7,2,\r\nverdict,7,3,c\r\ngap,7,1,\r\n";
        // As it comes, in pieces.
        text.as_bytes().chunks(3).for_each(|piece| csv.write_all(piece).unwrap());
        let expected = [
            "entry,epoch,seq,clip,part",
            "verdict,7,1,/a/b.mcap,\"a,b\"",
            "verdict,7,2,,",
            "verdict,7,3,\"/a,\"\"b\"\".mcap\",c",
            "gap,7,1,,",
            "",
        ];
        assert_eq!(String::from_utf8(out).unwrap(), expected.join("\r\n"));
    }
}
