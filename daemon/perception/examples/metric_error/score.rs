//! How far from the truth.

use crate::inputs::number;
use andon_perception::metric::{MetricObject, MetricScene};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use serde_json::Value;
use std::collections::BTreeMap;

#[derive(Default)]
pub(crate) struct Score {
    /// Errors by what they are of.
    errors: BTreeMap<(&'static str, &'static str), Vec<f64>>,
    ambiguous: usize,
}

/// Landmarks by how they are used.
const LANDMARKS: [(&str, &[usize]); 4] = [
    ("tips 8 12 16", &[8, 12, 16]),
    ("knuckle 9", &[9]),
    ("thumb 4", &[4]),
    ("all 21", &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20]),
];

impl Score {
    pub(crate) fn frame(&mut self, scene: &MetricScene, truth: &Value) {
        if let (Some(hand), Some(true_hand)) = (scene.hands.first(), truth["hands"].get(0)) {
            for (name, landmarks) in LANDMARKS {
                for &k in landmarks {
                    let error = vector(hand.landmarks_m[k]) - true_vector(&true_hand["m"][k]);
                    self.add(name, "mm", error.norm() * 1e3);
                    self.add(name, "mm, height", (error.z * 1e3).abs());
                }
            }
        }
        for object in &scene.objects {
            let true_object = truth["objects"].as_array().into_iter().flatten();
            if let Some(true_object) =
                true_object.into_iter().find(|each| number(&each["id"]) == f64::from(object.id))
            {
                self.object(object, true_object, truth["held"] == true_object["id"]);
            }
        }
    }

    fn object(&mut self, object: &MetricObject, truth: &Value, held: bool) {
        let name = if held { "marker, held" } else { "marker, at rest" };
        let error = vector(object.position_m) - true_vector(&truth["p"]);
        self.add(name, "mm", error.norm() * 1e3);
        self.add(name, "mm, height", (error.z * 1e3).abs());
        let [w, x, y, z] = object.orientation.map(f64::from);
        let seen = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        let q = |k: usize| number(&truth["q"][k]);
        let wanted = UnitQuaternion::from_quaternion(Quaternion::new(q(0), q(1), q(2), q(3)));
        let tilt = (seen * Vector3::z()).angle(&(wanted * Vector3::z()));
        self.add(name, "degrees, tilt", tilt.to_degrees());
        self.add(name, "degrees", seen.angle_to(&wanted).to_degrees());
        self.ambiguous += usize::from(!object.unambiguous);
    }

    fn add(&mut self, what: &'static str, unit: &'static str, error: f64) {
        self.errors.entry((what, unit)).or_default().push(error);
    }

    pub(crate) fn print(&mut self) {
        println!("{:34} {:>7} {:>8} {:>8} {:>8}", "error of", "count", "median", "95 %", "mean");
        for ((what, unit), errors) in &mut self.errors {
            let unknown = errors.iter().filter(|error| error.is_nan()).count();
            errors.retain(|error| !error.is_nan());
            errors.sort_unstable_by(f64::total_cmp);
            let at =
                |share: f64| errors.get((share * errors.len() as f64) as usize).copied().unwrap_or(f64::NAN);
            let mean = errors.iter().sum::<f64>() / errors.len() as f64;
            let count = errors.len();
            println!(
                "{:34} {count:7} {:8.2} {:8.2} {mean:8.2}   unknown {unknown}",
                format!("{what}, {unit}"),
                at(0.5),
                at(0.95)
            );
        }
        println!("ambiguous poses: {}", self.ambiguous);
    }
}

fn vector(point: [f32; 3]) -> Vector3<f64> {
    Vector3::from(point.map(f64::from))
}

fn true_vector(value: &Value) -> Vector3<f64> {
    Vector3::from([0, 1, 2].map(|axis| number(&value[axis])))
}
