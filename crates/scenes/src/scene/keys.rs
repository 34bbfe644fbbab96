//! The file as it is written: the keys that serde reads, before their values are checked against each other.

use super::observing::{Channel, Data, Method, Sensor, Study, Switch};
use super::place::Places;
use super::robot::{SceneGround, SceneRobot};
use super::simulated::{Body, LibraryBody};
use palmistry_bodies::mechanics::moving::{Course, PushedPalm};
use palmistry_lang::Problem;
use palmistry_observe::{HighGain, Kalman, Loss, Shooting, Unscented, WhenUnobservable};
use serde::Deserialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, Visitor};
use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneKeys {
    #[serde(deserialize_with = "palmistry_io::foreign::read_line")]
    pub title: String,
    pub model: PathBuf,
    #[serde(default = "one")]
    pub seed: u64,
    pub duration: Option<f64>,
    pub samples: Option<usize>,
    pub rate: Option<f64>,
    pub body: Option<Body>,
    pub palms: Option<PalmsKeys>,
    pub robot: Option<SceneRobot>,
    pub ground: Option<SceneGround>,
    pub start: Option<BTreeMap<String, f64>>,
    pub inputs: Option<BTreeMap<String, String>>,
    #[serde(default)]
    pub sensor: SensorKeys,
    #[serde(default)]
    pub columns: BTreeMap<String, ColumnKeys>,
    #[serde(default)]
    pub data: Data,
    pub observer: ObserverKeys,
    #[serde(default)]
    pub study: Study,
}

/// `[sensor]` and the tables in it.
#[derive(Default)]
pub(super) struct SensorKeys {
    pub sensor: Sensor,
    pub channels: BTreeMap<String, Channel>,
}

/// By hand, because every key that holds a table is the name of a column.
impl<'de> Deserialize<'de> for SensorKeys {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Keys;
        impl<'de> Visitor<'de> for Keys {
            type Value = SensorKeys;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a map")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<SensorKeys, A::Error> {
                let mut keys = SensorKeys::default();
                while let Some(key) = map.next_key::<String>()? {
                    match key.as_str() {
                        "noise" => keys.sensor.noise = map.next_value()?,
                        "resolution" => keys.sensor.resolution = map.next_value()?,
                        "jitter" => keys.sensor.jitter = map.next_value()?,
                        _ => match map.next_value()? {
                            ChannelKeys::Table(channel) => {
                                keys.channels.insert(key, channel);
                            }
                            ChannelKeys::Other => {
                                return Err(A::Error::unknown_field(
                                    &key,
                                    &["noise", "resolution", "jitter"],
                                ));
                            }
                        },
                    }
                }
                Ok(keys)
            }
        }
        deserializer.deserialize_map(Keys)
    }
}

/// The value of a key of `[sensor]` that is none of its own.
enum ChannelKeys {
    Table(Channel),
    Other,
}

impl<'de> Deserialize<'de> for ChannelKeys {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;
        impl<'de> Visitor<'de> for Either {
            type Value = ChannelKeys;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a map")
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<ChannelKeys, A::Error> {
                Channel::deserialize(MapAccessDeserializer::new(map)).map(ChannelKeys::Table)
            }

            fn visit_f64<E>(self, _: f64) -> Result<ChannelKeys, E> {
                Ok(ChannelKeys::Other)
            }

            fn visit_i64<E>(self, _: i64) -> Result<ChannelKeys, E> {
                Ok(ChannelKeys::Other)
            }

            fn visit_bool<E>(self, _: bool) -> Result<ChannelKeys, E> {
                Ok(ChannelKeys::Other)
            }

            fn visit_str<E>(self, _: &str) -> Result<ChannelKeys, E> {
                Ok(ChannelKeys::Other)
            }
        }
        deserializer.deserialize_any(Either)
    }
}

/// Where a column comes from, as it is written: the name in the file, or a table.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct ColumnKeys {
    pub from: Option<String>,
    pub unit: Option<String>,
    pub factor: Option<f64>,
    pub offset: Option<f64>,
}

impl<'de> Deserialize<'de> for ColumnKeys {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct Table {
            from: Option<String>,
            unit: Option<String>,
            factor: Option<f64>,
            offset: Option<f64>,
        }
        struct Either;
        impl<'de> Visitor<'de> for Either {
            type Value = ColumnKeys;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a string")
            }

            fn visit_str<E>(self, from: &str) -> Result<ColumnKeys, E> {
                Ok(ColumnKeys { from: Some(from.to_owned()), ..ColumnKeys::default() })
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<ColumnKeys, A::Error> {
                let Table { from, unit, factor, offset } =
                    Table::deserialize(MapAccessDeserializer::new(map))?;
                Ok(ColumnKeys { from, unit, factor, offset })
            }
        }
        deserializer.deserialize_any(Either)
    }
}

fn one() -> u64 {
    1
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PalmsKeys {
    pub inertia: [f64; 2],
    pub radii: Option<[f64; 2]>,
    #[serde(default)]
    pub friction: f64,
    pub prescribed: Option<[Course; 2]>,
    pub torques: Option<[PushedPalm; 2]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ObserverKeys {
    #[serde(default)]
    pub methods: Option<Vec<Method>>,
    pub estimate: Vec<String>,
    #[serde(default)]
    pub known: BTreeMap<String, f64>,
    #[serde(default)]
    pub inputs: BTreeMap<String, String>,
    pub guess: Option<GuessKeys>,
    pub guess_off: Option<f64>,
    #[serde(default)]
    pub clamp: Vec<String>,
    pub window: Option<usize>,
    #[serde(default = "five")]
    pub steps: usize,
    #[serde(default, alias = "when_blind")]
    pub when_unobservable: WhenUnobservable,
    #[serde(default = "unity", alias = "blind")]
    pub unobservable_above: f64,
    #[serde(default = "yes")]
    pub inherit: bool,
    #[serde(default)]
    pub whole: bool,
    #[serde(default)]
    pub bounds: BTreeMap<String, [f64; 2]>,
    #[serde(default)]
    pub loss: Loss,
    #[serde(default)]
    pub shooting: Shooting,
    #[serde(default)]
    pub kalman: Kalman,
    #[serde(default)]
    pub unscented: Unscented,
    #[serde(default)]
    pub high_gain: HighGain,
    #[serde(default)]
    pub mode: String,
    #[serde(default)]
    pub modes: Vec<ModeKeys>,
    #[serde(default)]
    pub library: Vec<LibraryBody>,
    pub switch: Option<Switch>,
}

/// `[[observer.modes]]`: another system that may explain the measurements, beside the scene's own.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ModeKeys {
    #[serde(deserialize_with = "palmistry_io::foreign::read_line")]
    pub name: String,
    pub model: PathBuf,
    pub estimate: Vec<String>,
    #[serde(default)]
    pub known: BTreeMap<String, f64>,
    #[serde(default)]
    pub inputs: BTreeMap<String, String>,
    pub guess: Option<GuessKeys>,
    #[serde(default)]
    pub bounds: BTreeMap<String, [f64; 2]>,
}

/// `guess`: values by name, or a word.
pub(super) enum GuessKeys {
    Values(BTreeMap<String, f64>),
    Word(String),
}

/// By hand, so that an error is reported for a value and not for the whole table.
impl<'de> Deserialize<'de> for GuessKeys {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;
        impl<'de> Visitor<'de> for Either {
            type Value = GuessKeys;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a map")
            }

            fn visit_str<E>(self, word: &str) -> Result<GuessKeys, E> {
                Ok(GuessKeys::Word(word.to_owned()))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<GuessKeys, A::Error> {
                BTreeMap::deserialize(MapAccessDeserializer::new(map)).map(GuessKeys::Values)
            }
        }
        deserializer.deserialize_any(Either)
    }
}

fn yes() -> bool {
    true
}

fn five() -> usize {
    5
}

fn unity() -> f64 {
    1.0
}

/// Reads the keys of a text.
pub(super) fn read(text: &str, places: &Places) -> Result<SceneKeys, Problem> {
    toml::from_str(text).map_err(|error| places.explain(&error))
}
