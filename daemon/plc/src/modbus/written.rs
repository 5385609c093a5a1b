//! Who has commanded what, for the audit.

use std::net::IpAddr;

use crate::registers::{Control, control};

/// Writes that nobody has asked for yet. More than these come only from a client that is broken, and are not kept.
pub(super) const MAX_WRITES: usize = 64;

/// One write of a client to the control block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Write {
    /// Who wrote.
    pub client: IpAddr,
    /// The control block before it.
    pub before: Control,
    /// And after it.
    pub after: Control,
}

impl Write {
    /// What it asks for, in words. An acknowledgement is not a command: it comes with every result.
    pub fn commands(&self) -> Vec<String> {
        let changed = self.before.word ^ self.after.word;
        let risen = changed & self.after.word;
        let mut commands = Vec::new();
        if changed & control::ENABLE != 0 {
            let word = if risen & control::ENABLE != 0 { "enable" } else { "disable" };
            commands.push(word.to_owned());
        }
        for (bit, word) in
            [(control::ABORT, "abort"), (control::START, "start"), (control::RESET_ERROR, "reset error")]
        {
            if risen & bit != 0 {
                commands.push(word.to_owned());
            }
        }
        if risen & control::LOAD_JOB != 0 {
            let (id, hash) = (self.after.load_job_id, self.after.load_model_hash);
            let version = if hash == 0 { String::new() } else { format!(" of hash {hash:016x}") };
            commands.push(format!("load job {id}{version}"));
        }
        if risen & control::SET_PART != 0 {
            let part = String::from_utf8_lossy(&self.after.part);
            commands.push(format!("part \"{}\"", part.trim_end_matches(['\0', ' ']).escape_default()));
        }
        commands
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn commands(before: u16, after: u16) -> Vec<String> {
        let client = IpAddr::from([192, 0, 2, 7]);
        let mut part = [0; 32];
        part[..3].copy_from_slice(b"A 1");
        let block = |word| Control { word, load_job_id: 3, part, ..Control::default() };
        Write { client, before: block(before), after: block(after) }.commands()
    }

    #[test]
    fn what_changes_is_a_command_and_an_acknowledgement_is_none() {
        assert_eq!(commands(0, control::ENABLE | control::LOAD_JOB), ["enable", "load job 3"]);
        assert_eq!(commands(control::ENABLE, control::ENABLE | control::ACKNOWLEDGE), [""; 0]);
        assert_eq!(commands(control::ENABLE | control::START, 0), ["disable"]);
        assert_eq!(commands(0, control::START | control::ABORT), ["abort", "start"]);
        assert_eq!(commands(0, control::SET_PART), [r#"part "A 1""#]);
    }
}
