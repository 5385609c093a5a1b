//! Questions of people to the journal, in SQL.

use std::io::Write;

use rusqlite::types::ValueRef;
use rusqlite::{Connection, params};
use shm_schemas::MessageId;

use super::History;
use super::csv::quoted;
use super::error::JournalError;
use super::row::signed;

/// The table `verdict` with one column more. Which clip there is only the folder of recordings says. A clip goes by age, by size and when somebody
/// removes it, and a name in the row would stay.
const CLIPS: &str = "
    CREATE TEMP TABLE clip (epoch INTEGER NOT NULL, seq INTEGER NOT NULL, path TEXT NOT NULL, PRIMARY KEY (epoch, seq))
        WITHOUT ROWID, STRICT;
    CREATE TEMP VIEW verdict AS SELECT written.*, clip.path AS clip
        FROM main.verdict AS written LEFT JOIN clip ON clip.epoch = written.epoch AND clip.seq = written.seq";

impl History {
    /// Writes what a question in SQL finds as CSV (RFC 4180), its columns in the first line. A value that is NULL is left empty. The table `verdict` also
    /// has the column `clip`: the recording that shows the verdict, of these, or NULL.
    ///
    /// # Errors
    /// [`JournalError::Question`] where it is none, or would change something; [`JournalError`] of the database; [`JournalError::Export`].
    pub fn write_sql<'c>(
        &self,
        question: &str,
        clips: impl IntoIterator<Item = (MessageId, &'c str)>,
        out: &mut impl Write,
    ) -> Result<(), JournalError> {
        add_clips(&self.connection, clips).map_err(|source| JournalError::of(&self.path, 0, source))?;
        let refused = |source: rusqlite::Error| match JournalError::of(&self.path, 0, source) {
            JournalError::Database { source, .. } => JournalError::Question(source.to_string()),
            other => other,
        };
        let mut statement = self.connection.prepare(question).map_err(refused)?;
        if !statement.readonly() {
            return Err(JournalError::Question("this would change the journal".into()));
        }
        let names: Vec<String> = statement.column_names().map(|name| quoted(name).into_owned()).collect();
        let columns = names.len();
        write!(out, "{}\r\n", names.join(","))?;
        let mut rows = statement.query([]).map_err(refused)?;
        while let Some(row) = rows.next().map_err(refused)? {
            for column in 0..columns {
                let comma = if column == 0 { "" } else { "," };
                let value = row.get_ref(column).map_err(refused)?;
                write!(out, "{comma}{}", text(value))?;
            }
            write!(out, "\r\n")?;
        }
        Ok(out.flush()?)
    }
}

fn add_clips<'c>(
    connection: &Connection,
    clips: impl IntoIterator<Item = (MessageId, &'c str)>,
) -> rusqlite::Result<()> {
    // They stay in memory.
    connection.pragma_update(None, "temp_store", "MEMORY")?;
    connection.execute_batch(CLIPS)?;
    let mut statement = connection.prepare("INSERT INTO clip VALUES (?1, ?2, ?3)")?;
    for (id, path) in clips {
        statement.execute(params![signed(id.epoch), signed(id.seq), path])?;
    }
    // From now on nothing is changed any more, whatever is asked.
    connection.pragma_update(None, "query_only", true)
}

fn text(value: ValueRef<'_>) -> String {
    match value {
        ValueRef::Null => String::new(),
        ValueRef::Integer(number) => number.to_string(),
        ValueRef::Real(number) => number.to_string(),
        ValueRef::Text(bytes) => quoted(&String::from_utf8_lossy(bytes)).into_owned(),
        ValueRef::Blob(bytes) => bytes.iter().map(|byte| format!("{byte:02x}")).collect(),
    }
}
