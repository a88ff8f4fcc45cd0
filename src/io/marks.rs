//! The physical groups of a file: which triangles or tetrahedra belong to them, and what they are called.
//!
//! Memory is linear in the file: an element holds the number of a set of groups, and sets are listed once.

use std::collections::{BTreeMap, HashMap};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Groups of elements of one dimension.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Marks {
    /// Names by number; of another dimension the same number is another group.
    names: BTreeMap<i64, String>,
    /// Numbers of groups, ascending, and how many elements belong to just these; the first is of those that belong to none.
    sets: Vec<(Vec<i64>, usize)>,
    /// The set of one group alone.
    alone: HashMap<i64, u32>,
}

/// A physical group.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Group {
    /// Above 0.
    pub(super) number: i64,
    pub(super) name: Option<String>,
    /// How many elements belong to it.
    pub(super) elements: usize,
}

/// A physical group as a user calls it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "the name of a physical group, or its number")]
pub enum GroupKey {
    /// Its number.
    Number(i64),
    /// Its name, in any letter case; or its number as a text.
    Name(String),
}

impl Default for Marks {
    fn default() -> Self {
        Self { names: BTreeMap::new(), sets: vec![(Vec::new(), 0)], alone: HashMap::new() }
    }
}

impl Marks {
    /// Calls the group `number` by `name`.
    pub(super) fn call(&mut self, number: i64, name: String) {
        self.names.insert(number.abs(), name);
    }

    /// The set of the groups `numbers`; 0 is none, and the sign says how a surface is turned.
    pub(super) fn set(&mut self, mut numbers: Vec<i64>) -> u32 {
        numbers.iter_mut().for_each(|number| *number = number.saturating_abs());
        numbers.retain(|&number| number != 0);
        numbers.sort_unstable();
        numbers.dedup();
        match numbers[..] {
            [] => 0,
            [number] => self.set_of(number),
            _ => {
                self.sets.push((numbers, 0));
                self.sets.len() as u32 - 1
            }
        }
    }

    /// The set of the group `number` alone.
    pub(super) fn set_of(&mut self, number: i64) -> u32 {
        let number = number.saturating_abs();
        if number == 0 {
            return 0;
        }
        *self.alone.entry(number).or_insert_with(|| {
            self.sets.push((vec![number], 0));
            self.sets.len() as u32 - 1
        })
    }

    /// Counts an element of the `set`.
    pub(super) fn count(&mut self, set: u32) {
        self.sets[set as usize].1 += 1;
    }

    /// How many elements belong to no group.
    pub(super) fn without_group(&self) -> usize {
        self.sets[0].1
    }

    /// All groups that have a name or elements, by number.
    pub(super) fn groups(&self) -> Vec<Group> {
        let mut elements: BTreeMap<i64, usize> =
            self.names.keys().map(|&number| (number, 0)).collect();
        for (numbers, count) in self.sets.iter().filter(|(_, count)| *count > 0) {
            for &number in numbers {
                *elements.entry(number).or_default() += count;
            }
        }
        let group =
            |(number, elements)| Group { number, name: self.names.get(&number).cloned(), elements };
        elements.into_iter().map(group).collect()
    }

    /// Whether elements of each set belong to one of `groups`.
    pub(super) fn in_groups(&self, groups: &[Group]) -> Vec<bool> {
        let is_in = |number: &i64| groups.iter().any(|group| group.number == *number);
        self.sets.iter().map(|(numbers, _)| numbers.iter().any(is_in)).collect()
    }
}

impl Group {
    /// Those of `groups` that `key` means: by the very name, by the name in another letter case, by the number.
    pub(super) fn meant(groups: &[Self], key: &GroupKey) -> Vec<Self> {
        let all = |is_meant: &dyn Fn(&Self) -> bool| -> Vec<Self> {
            groups.iter().filter(|group| is_meant(group)).cloned().collect()
        };
        let of_number = |number: i64| all(&|group| group.number == number);
        let name = match key {
            GroupKey::Number(number) => return of_number(*number),
            GroupKey::Name(name) => name.trim(),
        };
        let named = |is_name: &dyn Fn(&str) -> bool| {
            all(&|group| group.name.as_deref().is_some_and(|name| is_name(name.trim())))
        };
        let ways = [
            named(&|other| other == name),
            named(&|other| other.eq_ignore_ascii_case(name)),
            name.parse().map(of_number).unwrap_or_default(),
        ];
        ways.into_iter().find(|meant| !meant.is_empty()).unwrap_or_default()
    }

    /// The name with the number, or the number alone.
    pub(super) fn in_words(&self) -> String {
        match &self.name {
            Some(name) => format!("{name:?} ({})", self.number),
            None => self.number.to_string(),
        }
    }
}

impl GroupKey {
    /// As it stands in a scene file.
    pub(super) fn in_words(&self) -> String {
        match self {
            Self::Number(number) => number.to_string(),
            Self::Name(name) => format!("{name:?}"),
        }
    }
}

/// More groups than these are counted and not listed.
const MOST_LISTED: usize = 8;

/// `words` one after another, the first of them where there are many.
pub(super) fn listed(words: &[String]) -> String {
    let first = words[..words.len().min(MOST_LISTED)].join(", ");
    match words.len().checked_sub(MOST_LISTED) {
        None | Some(0) => first,
        Some(more) => format!("{first} and {more} more"),
    }
}
