//! What the help and the man pages say beyond the options: examples of every command, and the exit codes of all of them.

use clap::{Command, CommandFactory as _};

use super::Cli;

/// Examples of each command, each with what it does. They are complete command lines.
const EXAMPLES: &[(&str, &[(&str, &str)])] = &[
    (
        "demo",
        &[
            ("see every role at work, for three minutes", "andond demo"),
            ("keep the clips with what was seen and judged", "andond demo --speed max --annotate clips"),
            ("show what ran in a browser, until Ctrl-C", "andond demo --speed max --board"),
        ],
    ),
    (
        "new",
        &[
            ("answer questions about a new bench", "andond new bench1"),
            (
                "say everything at once",
                "andond new bench1 --part brick --part polisher=0.04 --camera /dev/video0 --hands right",
            ),
        ],
    ),
    (
        "install",
        &[(
            "as root: a station whose engineer eva teaches it on its board",
            "andond install bench1.toml --engineer eva",
        )],
    ),
    ("markers", &[("the sheets of a station, to be printed at 100 %", "andond markers -c bench1.toml")]),
    (
        "look",
        &[
            ("what the camera sees, and what to improve", "andond look -c bench1.toml"),
            ("live in a browser on this machine", "andond look -c bench1.toml --page"),
            ("the picture that calibrate needs", "andond look -c bench1.toml --save bench.png"),
        ],
    ),
    (
        "teach",
        &[
            (
                "learn a job from films and track files",
                "andond teach run1.mp4 run2.mp4 run3.tracks.jsonl --out jobs/polish.toml",
            ),
            (
                "show it at the bench instead, and look at the report in a browser",
                "andond teach --live --out jobs/polish.toml --report polish.html",
            ),
            (
                "teach it again with the runs that a person has confirmed",
                "andond teach --from-history --out jobs/polish.toml",
            ),
            (
                "teach it again with one more run and without another one",
                "andond teach --add run6.mp4 --without run2.mp4 --out jobs/polish.toml",
            ),
        ],
    ),
    (
        "replay",
        &[
            ("judge a film", "andond replay --job jobs/polish.toml run7.mp4"),
            (
                "keep the film with the verdicts drawn on it",
                "andond replay --job jobs/polish.toml run7.mp4 --annotate judged.mp4",
            ),
            (
                "judge a recording of the station again, as it was",
                "andond replay 00000042-20261128T072834.125Z.mcap",
            ),
            (
                "look at its pictures again as well",
                "andond replay --from-frames 00000042-20261128T072834.125Z.mcap",
            ),
        ],
    ),
    (
        "segment",
        &[
            ("see what a recording is divided into", "andond segment run1.tracks.jsonl"),
            (
                "draw it, where the station does not say where parts are touched",
                "andond segment run1.mp4 --job jobs/polish.toml --plot run1.svg",
            ),
        ],
    ),
    (
        "calibrate",
        &[(
            "four markers of 4 cm in a rectangle of 60 by 40 cm",
            "andond calibrate bench.png --side 0.04 --marker 40=0,0 --marker 41=0.6,0 --marker 42=0.6,0.4 --marker 43=0,0.4 --out bench.toml",
        )],
    ),
    (
        "record",
        &[("keep what the running station sees, until Ctrl-C", "andond record --out run1.tracks.jsonl")],
    ),
    (
        "tracks",
        &[(
            "look at a film once, and use what was seen as often as needed",
            "andond tracks run1.mp4 --out run1.tracks.jsonl",
        )],
    ),
    (
        "jobs",
        &[
            (
                "the jobs of a station, and which one is in force",
                "andond jobs -c /etc/andon/andon.toml -c /etc/andon/stations/bench1.toml",
            ),
            ("those of any folder", "andond jobs config/jobs"),
        ],
    ),
    (
        "use",
        &[
            ("load a job by its name, by its number or by its file", "andond use polish"),
            ("", "andond use 2"),
            ("", "andond use /etc/andon/jobs/polish.toml"),
        ],
    ),
    (
        "name",
        &[("what people read of its two steps", "andond name polish \"Polish the brick\" \"Measure it\"")],
    ),
    (
        "run",
        &[(
            "one role, as its unit runs it",
            "andond run judge -c /etc/andon/andon.toml -c /etc/andon/stations/bench1.toml",
        )],
    ),
    (
        "check",
        &[(
            "every fault of a station before it is started",
            "andond check -c /etc/andon/andon.toml -c /etc/andon/stations/bench1.toml",
        )],
    ),
    (
        "config",
        &[
            ("every key with its meaning, unit, range and default", "andond config --default"),
            ("what is in force", "andond config -c station.toml"),
        ],
    ),
    (
        "tail",
        &[
            ("follow a station", "andond tail"),
            ("only what was wrong or could not be judged, for a program", "andond tail --nok --json"),
        ],
    ),
    ("status", &[("for a person", "andond status"), ("for a program", "andond status --json")]),
    (
        "history",
        &[
            ("what was wrong in the last shift", "andond history --since 8h --nok"),
            ("everything about one part", "andond history --part SN-4711"),
            (
                "how many were right, and what was wrong with the others",
                "andond history --since 7d --summary",
            ),
            ("the same as a picture", "andond history --since 7d --plot week.svg"),
            ("who has changed what", "andond history --since 7d --audit"),
            (
                "which verdicts have a clip",
                "andond history --sql \"SELECT id, clip FROM verdict WHERE clip IS NOT NULL\"",
            ),
        ],
    ),
    (
        "clip",
        &[
            ("where the recording of a verdict is", "andond clip 4711"),
            ("a film of it, with what was seen and judged", "andond clip 4711 --annotate fault.mp4"),
        ],
    ),
    (
        "confirm",
        &[
            ("an accused piece was right after all", "andond confirm 4711 right"),
            ("this one was not", "andond confirm 4712 wrong"),
        ],
    ),
    ("whatif", &[("before another job is used", "andond whatif --since 7d --job jobs/polish-2.toml")]),
    (
        "forget",
        &[
            ("what is older than a month", "andond forget --before 30d"),
            ("everything about one part", "andond forget --part SN-4711"),
        ],
    ),
    ("explain", &[("what a message in the log means, and what to do", "andond explain AND-307")]),
    ("backup", &[("also while the station runs", "andond backup bench1.tar")]),
    (
        "restore",
        &[
            ("look into an archive", "andond restore --list bench1.tar"),
            ("put everything back", "andond restore --replace bench1.tar"),
        ],
    ),
    ("idle", &[("wait for a minute at most", "andond idle --timeout 60")]),
    (
        "part",
        &[
            ("the id of the next part, from a scanner", "andond part SN-4711"),
            ("the next part has none", "andond part \"\""),
        ],
    ),
    (
        "board",
        &[
            ("a certificate for the names in the configuration", "andond board certificate"),
            (
                "somebody who may say whether a verdict was right",
                "andond board login maria --role technician",
            ),
            ("a screen at the bench", "andond board kiosk bench1"),
            ("somebody has left", "andond board remove maria"),
        ],
    ),
    (
        "analyze",
        &[
            (
                "recordings that are named p1_none_r1, p2_none_r1 ...",
                "andond analyze recordings --out report",
            ),
            (
                "films that are named anna-polish-3.mp4 ...",
                "andond analyze films --names \"{person}-{what}-{run}\" --out report",
            ),
            ("a table says who did what", "andond analyze films --runs films/runs.csv --out report"),
        ],
    ),
    (
        "experiment",
        &[
            ("the second experiment of the paper", "andond experiment 2 recordings"),
            ("what each rule gains on two data sets", "andond experiment 2 --ladder recordings others"),
        ],
    ),
    (
        "completions",
        &[(
            "for bash, now and from now on",
            "andond completions bash > ~/.local/share/bash-completion/completions/andond",
        )],
    ),
];

/// The exit codes of all commands: the code, and what it means.
pub(super) const EXIT_CODES: &[(&str, &str)] = &[
    (
        "0",
        "success, or stopped on request; replay, whatif: all is correct; status: all roles are healthy; idle: no job is running",
    ),
    (
        "1",
        "replay, whatif: an anomaly; status: some role is not healthy; idle: a job is still running; teach: nothing was written, because the runs cannot be trusted or none was kept; use: the judge has refused the job; forget: what is being written stays",
    ),
    ("2", "replay, whatif: nothing is wrong, but something could not be judged"),
    ("64", "the command line is wrong, or a file that it names cannot be used; the message says what to do"),
    (
        "70",
        "something that it needs has failed, such as a running station; a unit starts the role again; check: the configuration is right, and this machine lacks what it needs, such as the camera",
    ),
    ("71", "it made no progress; a unit starts the role again"),
    ("72", "an error in andond itself (AND-614); a unit starts the role again"),
    (
        "78",
        "the configuration is wrong, or what it names is missing or damaged; a unit does not start the role again",
    ),
    ("141", "the output pipe was closed, as by `| head`"),
];

/// The whole command line, with the examples of each command and the exit codes.
pub fn command() -> Command {
    let table = exit_table();
    let command = Cli::command()
        .after_help("Exit codes: `andond help exit-codes`")
        .after_long_help(table.clone())
        .mut_subcommand("exit-codes", |command| command.help_template("{after-help}").after_help(table));
    EXAMPLES.iter().fold(command, |command, (name, examples)| {
        let text: String = examples.iter().map(|(what, line)| example(what, line)).collect();
        command.mut_subcommand(name, |command| command.after_help(format!("Examples:\n{text}")))
    })
}

/// The examples of a command, each with what it does.
pub(crate) fn examples(command: &str) -> &'static [(&'static str, &'static str)] {
    EXAMPLES.iter().find(|(name, _)| *name == command).map_or(&[], |(_, examples)| examples)
}

/// The exit codes as a table.
pub(crate) fn exit_table() -> String {
    let codes: String = EXIT_CODES.iter().map(|(code, meaning)| wrapped(code, meaning)).collect();
    format!("Exit codes:\n{codes}")
}

/// The exit codes for the man page.
pub(crate) fn exit_codes() -> &'static [(&'static str, &'static str)] {
    EXIT_CODES
}

fn example(what: &str, line: &str) -> String {
    let comment = if what.is_empty() { String::new() } else { format!("  # {what}\n") };
    format!("{comment}  {}\n", continued(line))
}

/// The widest help that is still read well.
const WIDTH: usize = 100;

/// The widest part of an example, with room for what stands around it in a terminal of 80 columns.
const EXAMPLE_WIDTH: usize = 72;

/// A command line in as many as a narrow terminal needs, which a shell reads as one. Clap would break a long one anywhere.
fn continued(line: &str) -> String {
    let mut options = line.split(" --");
    let mut rows = vec![options.next().unwrap_or_default().to_owned()];
    for option in options.map(|option| format!(" --{option}")) {
        match rows.last_mut() {
            Some(row) if row.chars().count() + option.chars().count() <= EXAMPLE_WIDTH => *row += &option,
            _ => rows.push(option),
        }
    }
    rows.join(" \\\n     ")
}

/// A row of the table of exit codes. Clap would begin the second line of a meaning under the code.
fn wrapped(code: &str, meaning: &str) -> String {
    let mut rows = vec![format!("  {code:>3} ")];
    for word in meaning.split(' ') {
        let row = rows.last_mut();
        match row {
            Some(row) if row.chars().count() + 1 + word.chars().count() <= WIDTH => {
                row.push(' ');
                row.push_str(word);
            }
            _ => rows.push(format!("       {word}")),
        }
    }
    rows.join("\n") + "\n"
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use andon_host::exit::Code;

    /// The words of a command line, as a shell divides it.
    fn words(line: &str) -> Vec<String> {
        let joined = line.replace("\\\n", " ");
        let command = joined.split(" > ").next().unwrap();
        command
            .split('"')
            .enumerate()
            .flat_map(|(number, part)| match number % 2 {
                0 => part.split_whitespace().map(str::to_owned).collect(),
                _ => vec![part.to_owned()],
            })
            .collect()
    }

    #[test]
    fn every_command_has_examples_and_they_are_right() {
        for subcommand in Cli::command().get_subcommands().filter(|command| !command.is_hide_set()) {
            let name = subcommand.get_name();
            assert!(!examples(name).is_empty(), "{name} has no example in cli/help.rs");
            // Clap breaks what is too long, and takes {n} for the end of a line.
            let mut shown = command().term_width(80);
            shown.build();
            let shown = shown.find_subcommand_mut(name).unwrap().render_help().to_string();
            for (_, line) in examples(name) {
                assert!(shown.contains(&format!("\n  {}\n", continued(line))), "{line}: {shown}");
                assert_eq!(words(&continued(line)), words(line));
                let parsed = command().try_get_matches_from(words(line));
                let matches = parsed.unwrap_or_else(|error| unreachable!("{line}: {error}"));
                assert_eq!(matches.subcommand_name(), Some(name), "{line}");
            }
        }
    }

    #[test]
    fn every_help_text_fits_in_a_hundred_columns() {
        let mut command = command().term_width(WIDTH);
        command.build();
        let mut texts = vec![command.render_long_help().to_string()];
        for subcommand in command.get_subcommands_mut() {
            texts.push(subcommand.render_long_help().to_string());
            texts.push(subcommand.render_help().to_string());
        }
        for line in texts.iter().flat_map(|text| text.lines()) {
            assert!(line.chars().count() <= WIDTH, "{line}");
        }
    }

    #[test]
    fn every_code_that_a_process_ends_with_is_in_the_table() {
        let codes = [
            Code::Stopped,
            Code::Declined,
            Code::Usage,
            Code::Fault,
            Code::NoProgress,
            Code::Panic,
            Code::Configuration,
            Code::Unread,
        ];
        for code in codes {
            let number = (code as u8).to_string();
            assert!(EXIT_CODES.iter().any(|(listed, _)| **listed == number), "{code:?}");
        }
    }
}
