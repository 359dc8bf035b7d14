//! What a handful of times says: quantiles rather than means, since a time has no limit upwards.

/// Times in ms, described. Quantiles are of the samples there are; [`dropped`](Self::dropped) counts those there are not.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Summary {
    /// Half of the samples are below.
    pub median: f64,
    /// 5 % are below.
    pub p5: f64,
    /// 95 % are below.
    pub p95: f64,
    /// The smallest.
    pub min: f64,
    /// Median absolute deviation from the median: half of the samples are closer to it than this.
    pub mad: f64,
    /// Samples.
    pub n: usize,
    /// Samples that could not be had: a stamp was not available, or not a number.
    pub dropped: usize,
}

impl Summary {
    /// Describes samples; none where not one is a finite number.
    pub fn of(samples: &[Option<f64>]) -> Option<Summary> {
        let mut sorted: Vec<f64> = samples.iter().flatten().copied().filter(|s| s.is_finite()).collect();
        sorted.sort_by(f64::total_cmp);
        let median = quantile(&sorted, 0.5)?;
        let mut away: Vec<f64> = sorted.iter().map(|s| (s - median).abs()).collect();
        away.sort_by(f64::total_cmp);
        Some(Summary {
            median,
            p5: quantile(&sorted, 0.05)?,
            p95: quantile(&sorted, 0.95)?,
            min: *sorted.first()?,
            mad: quantile(&away, 0.5)?,
            n: sorted.len(),
            dropped: samples.len() - sorted.len(),
        })
    }
}

/// The q-quantile (0..1) of ascending samples, linear between neighbours; none where there is no sample.
pub fn quantile(sorted: &[f64], q: f64) -> Option<f64> {
    let last = sorted.len().checked_sub(1)?;
    let at = q.clamp(0., 1.) * last as f64;
    let (low, high) = (sorted.get(at.floor() as usize)?, sorted.get(at.ceil() as usize)?);
    Some(low + (high - low) * at.fract())
}

/// Position of the sample closest to the median; none where no sample is finite.
pub fn median_index(samples: &[f64]) -> Option<usize> {
    let all: Vec<Option<f64>> = samples.iter().copied().map(Some).collect();
    let median = Summary::of(&all)?.median;
    let away = |i: &usize| (samples[*i] - median).abs();
    (0..samples.len()).filter(|i| samples[*i].is_finite()).min_by(|a, b| away(a).total_cmp(&away(b)))
}

/// Whether the newest `window` samples tell the same median as the `window` before them, to `tolerance` of it.
pub fn settled(samples: &[f64], window: usize, tolerance: f64) -> bool {
    let Some(start) = samples.len().checked_sub(2 * window) else { return false };
    let median = |part: &[f64]| {
        let mut sorted = part.to_vec();
        sorted.sort_by(f64::total_cmp);
        quantile(&sorted, 0.5)
    };
    match (median(&samples[start..start + window]), median(&samples[start + window..])) {
        (Some(before), Some(after)) => (after - before).abs() <= tolerance * before.abs(),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Holds a summary function to the figures of a series worked out on paper.
    fn caught(summarise: impl Fn(&[Option<f64>]) -> Option<Summary>) -> bool {
        // One frame in nine was interrupted; one had no stamp.
        let mut series: Vec<Option<f64>> = [3., 1., 2., 5., 4., 6., 8., 7., 900.].into_iter().map(Some).collect();
        series.push(None);
        let want = Summary { median: 5., p5: 1.4, p95: 543.2, min: 1., mad: 2., n: 9, dropped: 1 };
        let Some(got) = summarise(&series) else { return true };
        let pairs = [
            (got.median, want.median),
            (got.p5, want.p5),
            (got.p95, want.p95),
            (got.min, want.min),
            (got.mad, want.mad),
        ];
        (got.n, got.dropped) != (want.n, want.dropped) || pairs.iter().any(|(a, b)| (a - b).abs() > 1e-9)
    }

    #[test]
    fn the_summary_is_right_and_wrong_ones_are_caught() {
        assert!(!caught(Summary::of));
        let with = |change: fn(&mut Summary, &[Option<f64>])| {
            caught(move |s| {
                let mut summary = Summary::of(s)?;
                change(&mut summary, s);
                Some(summary)
            })
        };
        assert!(with(|s, all| s.median = all.iter().flatten().sum::<f64>() / s.n as f64), "a mean");
        assert!(with(|s, _| s.p95 = 900.), "a maximum");
        assert!(with(|s, all| s.mad = all.iter().flatten().map(|x| (x - s.median).abs()).sum::<f64>() / 9.), "a mean");
        assert!(with(|s, _| s.dropped = 0), "a silent drop");
        assert!(
            caught(|all| Summary::of(&all.iter().map(|s| Some(s.unwrap_or(0.))).collect::<Vec<_>>())),
            "a missing sample read as no time at all"
        );
    }

    #[test]
    fn nothing_gives_nothing() {
        assert_eq!(Summary::of(&[]), None);
        assert_eq!(Summary::of(&[None, Some(f64::NAN)]), None);
        assert_eq!(median_index(&[f64::NAN]), None);
    }

    #[test]
    fn one_sample_is_all_its_quantiles() {
        let one = Summary::of(&[Some(2.)]);
        assert_eq!(one, Some(Summary { median: 2., p5: 2., p95: 2., min: 2., mad: 0., n: 1, dropped: 0 }));
    }

    #[test]
    fn the_median_frame_is_one_of_the_frames() {
        assert_eq!(median_index(&[9., 1., 4., 100., 5.]), Some(4));
    }

    #[test]
    fn a_falling_series_has_not_settled() {
        let falling: Vec<f64> = (0..10).map(|i| 100. - 5. * f64::from(i)).collect();
        assert!(!settled(&falling, 5, 0.02));
        assert!(!settled(&[1.; 9], 5, 0.02), "too few to tell");
        assert!(settled(&[9., 8., 1., 1., 1., 1., 1., 1., 1., 1., 1., 50., 1.], 5, 0.02), "one outlier is no drift");
    }
}
