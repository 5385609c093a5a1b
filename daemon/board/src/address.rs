//! The address of a page: which page, in which language, which events. Every link keeps what it does not change.

/// A page for people.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) enum Page {
    #[default]
    Worker,
    Technician,
    /// One event, which `at` names.
    Event,
    /// What the codes of messages mean.
    Explain,
    /// What an engineer orders, and what came of it.
    Engineer,
    /// One job, which `at` names.
    Job,
    /// The picture alone, with what to improve.
    Look,
}

impl Page {
    const ALL: [Self; 7] =
        [Self::Worker, Self::Technician, Self::Event, Self::Explain, Self::Engineer, Self::Job, Self::Look];

    /// Where it is.
    pub(crate) const fn path(self) -> &'static str {
        match self {
            // Where there is the one, there is not the other.
            Self::Worker | Self::Look => "/",
            Self::Technician => "/technician",
            Self::Event => "/technician/event",
            Self::Explain => "/technician/explain",
            Self::Engineer => "/engineer",
            Self::Job => "/engineer/job",
        }
    }

    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Worker => "worker",
            Self::Technician => "technician",
            Self::Event => "event",
            Self::Explain => "explain",
            Self::Engineer => "engineer",
            Self::Job => "job",
            Self::Look => "look",
        }
    }

    /// The page at this path, of those that there are: with `is_look` the picture alone.
    pub(crate) fn at(path: &str, is_look: bool) -> Option<Self> {
        Self::ALL.into_iter().find(|page| page.path() == path && (*page == Self::Look) == is_look)
    }
}

/// What the query of an address says. Empty is not said.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct Address {
    pub(crate) page: Page,
    /// The code of the language.
    pub(crate) lang: String,
    /// The key of the fault to which the events are limited.
    pub(crate) fault: String,
    /// The word of the level to which the events are limited.
    pub(crate) level: String,
    /// The part id to which they are limited.
    pub(crate) part: String,
    /// The event that the list begins with; without it the newest.
    pub(crate) at: String,
    /// The number of a picture of the event's film; without it the one that was decided on.
    pub(crate) frame: String,
    /// The number of a code of the log.
    pub(crate) code: String,
    /// `on` where a fault is to be heard.
    pub(crate) sound: String,
    /// Whether the reader may say that a verdict was right. No query says so.
    pub(crate) may_confirm: bool,
}

/// No language, fault or event has a longer name, nor has a job with one of its versions. Every row of a list repeats the values in its link.
const LONGEST: usize = 80;

/// What values are made of; any other value is ignored.
pub(crate) fn is_plain(value: &str) -> bool {
    value.len() <= LONGEST && value.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"._-".contains(&byte))
}

impl Address {
    pub(crate) fn new(page: Page, query: &str) -> Self {
        let mut address = Self { page, ..Self::default() };
        for (key, value) in query.split('&').filter_map(|pair| pair.split_once('=')) {
            let place = match key {
                "lang" => &mut address.lang,
                "fault" => &mut address.fault,
                "level" => &mut address.level,
                "part" => &mut address.part,
                "at" => &mut address.at,
                "frame" => &mut address.frame,
                "code" => &mut address.code,
                "sound" => &mut address.sound,
                _ => continue,
            };
            if is_plain(value) {
                value.clone_into(place);
            }
        }
        address
    }

    /// The address in which a stream of events says which page it belongs to.
    pub(crate) fn of_events(query: &str) -> Self {
        let pages = Page::ALL.into_iter();
        let page = pages
            .rev()
            .find(|page| query.split('&').any(|pair| pair.strip_prefix("view=") == Some(page.name())));
        Self::new(page.unwrap_or_default(), query)
    }

    /// The name that a browser has given itself, which all its tabs have; empty where it has none.
    pub(crate) fn browser(query: &str) -> &str {
        let mut values = query.split('&').filter_map(|pair| pair.strip_prefix("browser="));
        values.next().filter(|name| is_plain(name)).unwrap_or_default()
    }

    /// Where the events of this page are.
    pub(crate) fn events(&self) -> String {
        format!("/events?view={}{}", self.page.name(), self.query('&'))
    }

    /// A link to it.
    pub(crate) fn link(&self) -> String {
        format!("{}{}", self.page.path(), self.query('?'))
    }

    /// The address in the query of a login, or in a form: `to` is the page.
    pub(crate) fn of_login(query: &str) -> Self {
        let pages = Page::ALL.into_iter();
        let is_named =
            |page: &Page| query.split('&').any(|pair| pair.strip_prefix("to=") == Some(page.name()));
        Self::new(pages.rev().find(is_named).unwrap_or_default(), query)
    }

    /// The way to a login that leads back to here.
    pub(crate) fn login(&self) -> String {
        format!("/login?to={}{}", self.page.name(), self.query('&'))
    }

    /// What a form sends to come back to here.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = (&'static str, &str)> {
        std::iter::once(("to", self.page.name())).chain(self.said())
    }

    fn said(&self) -> impl Iterator<Item = (&'static str, &str)> {
        let pairs = [
            ("lang", self.lang.as_str()),
            ("fault", &self.fault),
            ("level", &self.level),
            ("part", &self.part),
            ("at", &self.at),
            ("frame", &self.frame),
            ("code", &self.code),
            ("sound", &self.sound),
        ];
        pairs.into_iter().filter(|(_, value)| !value.is_empty())
    }

    /// A picture of the event's film.
    pub(crate) fn picture(&self) -> String {
        format!("/technician/film/frame.svg{}", self.query('?'))
    }

    /// The same language and events on another page.
    pub(crate) fn on(&self, page: Page) -> Self {
        Self { page, frame: String::new(), code: String::new(), ..self.clone() }
    }

    fn query(&self, first: char) -> String {
        let separators = std::iter::once(first).chain(std::iter::repeat('&'));
        separators
            .zip(self.said())
            .map(|(separator, (key, value))| format!("{separator}{key}={value}"))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_comes_back_from_its_links() {
        let query = "lang=de&fault=Duration.below&level=job&part=A-7&at=17-4&frame=3&sound=on";
        let address = Address::new(Page::Event, query);
        assert_eq!(address.link(), format!("/technician/event?{query}"));
        let events = address.events();
        assert_eq!(Address::of_events(events.split_once('?').map_or("", |(_, query)| query)), address);
        let login = address.login();
        assert_eq!(Address::of_login(login.split_once('?').map_or("", |(_, query)| query)), address);
        assert_eq!(Address::of_events("view=nothing"), Address::default());
        assert_eq!(Address::default().link(), "/");
    }

    #[test]
    fn the_name_of_a_browser_is_no_part_of_what_its_page_shows() {
        let query = "view=technician&at=17-4&browser=k3v9";
        assert_eq!(Address::browser(query), "k3v9");
        assert_eq!(Address::of_events(query), Address::of_events("view=technician&at=17-4"));
        assert_eq!(["view=worker", "browser=%3Cscript", ""].map(Address::browser), ["", "", ""]);
    }

    #[test]
    fn a_value_that_is_longer_than_any_name_is_ignored() {
        let of_length = |length| Address::new(Page::Technician, &format!("at={}", "7".repeat(length)));
        assert_eq!(of_length(LONGEST).at.len(), LONGEST);
        assert_eq!(of_length(LONGEST + 1).at, "");
        let longest = format!("{}-{}", u64::MAX, u64::MAX);
        assert_eq!(Address::new(Page::Technician, &format!("at={longest}")).at, longest);
    }

    #[test]
    fn a_value_with_other_characters_is_ignored() {
        for query in [
            "lang=<script>",
            "fault=%3Cscript%3E",
            "at=a%00b",
            "lang=../../etc",
            "lang",
            "=",
            "&&=&",
            "lang=d\u{e9}",
        ] {
            assert_eq!(Address::new(Page::Worker, query), Address::default(), "{query}");
        }
    }
}
