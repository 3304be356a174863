//! What to say if a time limit ends before there is a picture.

use crate::formatting::duration;

/// A time limit, and how long the work before the first picture took, as far as it is done. Times are in seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TimeSpent {
    /// The limit, counted from the start of the program.
    pub limit_s: f64,
    /// Time until the first ray.
    pub prepared_s: Option<f64>,
    /// Time of the first pass over the frame.
    pub pass_s: Option<f64>,
}

impl TimeSpent {
    /// Explains why there is no picture after `now_s` seconds.
    #[must_use]
    pub fn too_short(&self, now_s: f64) -> String {
        let limit = duration(self.limit_s);
        let what = match (self.prepared_s, self.pass_s) {
            (None, _) => "preparation takes longer than that".to_owned(),
            (Some(prepared), None) => format!(
                "preparation took {}, the first pass over the frame takes more than {}, and development comes after it",
                duration(prepared),
                duration(now_s - prepared)
            ),
            (Some(prepared), Some(pass)) => format!(
                "preparation took {}, the first pass over the frame {}, and development takes more than {}",
                duration(prepared),
                duration(pass),
                duration(now_s - prepared - pass)
            ),
        };
        format!("the time limit of {limit} is too short for a picture: {what}; nothing was written")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_took_how_long_is_told() {
        let mut spent = TimeSpent { limit_s: 2.0, ..TimeSpent::default() };
        assert!(spent.too_short(2.0).contains("preparation takes longer"));
        spent.prepared_s = Some(1.5);
        assert!(
            spent
                .too_short(2.0)
                .contains("preparation took 1.5 s, the first pass over the frame takes more than 0.5 s")
        );
        spent.pass_s = Some(0.25);
        assert!(
            spent.too_short(2.0).ends_with("development takes more than 0.2 s; nothing was written"),
            "{}",
            spent.too_short(2.0)
        );
    }
}
