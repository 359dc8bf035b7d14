//! Fewer Gaussians for a profile: energy, what is few already, the distance by quadrature, and that no neighbour is nearer.
use pdss::skin::profile::{Gaussian, Profile, distance, fewer};

const PROFILES: [&str; 6] = ["skin", "skin1", "marble", "wholemilk", "ketchup", "potato"];

fn gaussians(name: &str) -> Vec<Gaussian> {
    Profile::resolve(name).expect("built in").gaussians().gaussians
}

/// What is left x mm beyond a straight edge of light.
fn edge(list: &[Gaussian], c: usize, x: f64) -> f64 {
    let one = |g: &Gaussian| match g.variance {
        0. => f64::from(u8::from(x < 0.)),
        v => 0.5 * libm::erfc(x / (2. * v).sqrt()),
    };
    list.iter().map(|g| g.weight[c] * one(g)).sum()
}

#[test]
fn the_distance_is_what_edges_of_light_differ_by() {
    for name in PROFILES {
        let all = gaussians(name);
        let few = fewer(&all, 2, 1e-4);
        let reach = 8. * all.iter().map(|g| g.variance.sqrt()).fold(0., f64::max);
        let steps = 400_000;
        let h = 2. * reach / f64::from(steps);
        let at = |i: i32| h * (f64::from(i) + 0.5) - reach;
        let square = |i: i32| (0..3).map(|c| (edge(&all, c, at(i)) - edge(&few, c, at(i))).powi(2)).sum::<f64>();
        let (told, found) = (distance(&all, &few), 2. * h * (0..steps).map(square).sum::<f64>());
        println!("{name}: {told:.6} mm, by quadrature {found:.6}");
        assert!((told - found).abs() < 1e-4 * told, "{told} and {found}");
        // The twin: variances half as large again.
        let moved: Vec<Gaussian> = few.iter().map(|g| Gaussian { variance: 1.5 * g.variance, ..*g }).collect();
        assert!((distance(&all, &moved) - found).abs() > 1e-4 * told);
    }
}

#[test]
fn energy_is_kept_and_what_is_few_stays() {
    for name in PROFILES {
        let all = gaussians(name);
        let energy = |list: &[Gaussian], c: usize| list.iter().map(|g| g.weight[c]).sum::<f64>();
        for most in 1..=7 {
            for least in [0., 1e-3, 0.1, 1e9] {
                let few = fewer(&all, most, least);
                let wide = |l: &[Gaussian]| l.iter().filter(|g| g.variance > 0. && g.variance >= least).count();
                assert!(wide(&few) <= most, "{name}: {} of {most}", wide(&few));
                assert!(few.windows(2).all(|w| w[0].variance < w[1].variance));
                assert!(few.iter().flat_map(|g| g.weight).all(|w| w >= 0.));
                (0..3).for_each(|c| assert!((energy(&few, c) - energy(&all, c)).abs() < 1e-9, "{name}, {most}, {c}"));
                if wide(&all) <= most {
                    assert!(distance(&all, &few).abs() < 1e-12);
                }
            }
        }
    }
}

/// Neighbours in variance made one of their mean variance, until so many are left.
fn merged(mut list: Vec<Gaussian>, most: usize) -> Vec<Gaussian> {
    while list.len() > most {
        let energy = |g: &Gaussian| g.weight.iter().sum::<f64>();
        let cost = |i: &usize| {
            let (a, b) = (energy(&list[*i]), energy(&list[i + 1]));
            a * b / (a + b) * (list[i + 1].variance.sqrt() - list[*i].variance.sqrt()).powi(2)
        };
        let i = (0..list.len() - 1).min_by(|a, b| cost(a).total_cmp(&cost(b))).unwrap();
        let (a, b) = (list[i], list.remove(i + 1));
        let variance = (a.variance * energy(&a) + b.variance * energy(&b)) / (energy(&a) + energy(&b));
        list[i] = Gaussian { variance, weight: std::array::from_fn(|c| a.weight[c] + b.weight[c]) };
    }
    list
}

#[test]
fn nothing_near_by_is_nearer_and_merging_is_much_further() {
    for name in PROFILES {
        let all = gaussians(name);
        for most in 2..=4 {
            let few = fewer(&all, most, 1e-6);
            let reached = distance(&all, &few);
            let merging = distance(&all, &merged(all.clone(), most));
            println!("{name}, {most}: {reached:.5} mm, merging {merging:.5} ({:.1} times)", merging / reached);
            assert!(merging > 1.5 * reached, "the twin is no worse");
            // A twentieth of any weight moved to another Gaussian of its channel, or any variance a quarter off.
            for i in 0..few.len() {
                for j in (0..few.len()).filter(|j| *j != i) {
                    for c in 0..3 {
                        let mut other = few.clone();
                        let share = 0.05 * other[i].weight[c];
                        (other[i].weight[c], other[j].weight[c]) =
                            (0.95 * other[i].weight[c], other[j].weight[c] + share);
                        assert!(distance(&all, &other) >= reached - 1e-12, "{name}: {i} to {j}, channel {c}");
                    }
                }
                for factor in [0.75, 1.33] {
                    let mut other = few.clone();
                    other[i].variance *= factor;
                    assert!(distance(&all, &other) >= reached - 1e-12, "{name}: variance {i} times {factor}");
                }
            }
        }
    }
}
