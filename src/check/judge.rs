//! From errors to an answer: right, or which mistakes explain the picture, or none of them.

use super::measure::{Noise, SAME, Values, contrast, mse, rmse, stands_out, surely_nearer};
use super::{Mistake, Mode, all};

/// The short answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The picture is right.
    Right,
    /// A mistake explains it.
    Mistake,
    /// It is not right, and none of the mistakes explains it.
    Unexplained,
}

/// One mistake and what it explains.
#[derive(Clone, Debug)]
pub struct Finding {
    /// The mistake.
    pub mistake: &'static Mistake,
    /// The mode in which it was made.
    pub mode: Mode,
    /// How much of it, in scene units; `None` for mistakes that are made or not.
    pub amount: Option<f64>,
    /// rmse between the given picture and the mistaken one.
    pub error: f64,
    /// The part of the right picture's error (of the same mode) that it removes, at most 1.
    pub removed: f64,
    /// It cannot be told from the best one on this scene.
    pub tied: bool,
}

/// The right picture of a mode.
pub(super) struct Right {
    pub(super) mode: Mode,
    pub(super) picture: Values,
    pub(super) error: f64,
}

impl Right {
    pub(super) fn new(mode: Mode, picture: Values, given: &Values) -> Self {
        let error = rmse(&picture, given);
        Self {
            mode,
            picture,
            error,
        }
    }
}

/// The picture of a mistake.
#[derive(Clone)]
pub(super) struct Candidate {
    /// Its number.
    pub(super) mistake: usize,
    pub(super) mode: Mode,
    pub(super) amount: f64,
    pub(super) error: f64,
    pub(super) picture: Values,
}

/// The answer, in numbers of what was judged.
pub(super) struct Judged {
    pub(super) verdict: Verdict,
    pub(super) mode: Mode,
    pub(super) also: Vec<Mode>,
    /// The right picture of that mode.
    pub(super) right: usize,
    /// The best mistake, where there is one.
    pub(super) best: Option<usize>,
    pub(super) findings: Vec<Finding>,
}

/// Findings that are told at most, and those among them that only help.
const TOLD: usize = 5;
const HELPING: usize = 2;

/// A mistake explains a picture that noise does not explain if this part of the error goes,
const EXPLAINS: f64 = 0.5;
/// and what stays is at most this part of the contrast of the right picture: else the picture shows something else.
const STAYS: f64 = 0.3;

/// Standard deviations from which on a mistake is believed that removes little of the error.
const SURE: f64 = 4.0;

/// Part of pairs of neighbouring pixels that differ in kind, from where on pixels count as strewn: a shadow of 8 x 8
/// pixels has 1/8, half of all pixels by chance 1/2.
const STREWN: f64 = 0.12;
/// Values that a strewn pixel must change by.
const STREWN_LEAST: f32 = 16.0 / 255.0;

/// `right` with those pixels of `wrong` that are nearer to the given picture; `None` where they are not strewn, but make
/// regions: then something else is wrong.
pub(super) fn strewn(given: &Values, right: &Values, wrong: &Values) -> Option<Values> {
    let distance = |a: &[f32; 3], b: &[f32; 3]| (0..3).map(|c| (a[c] - b[c]).powi(2)).sum::<f32>();
    // None: the two do not differ there.
    let kinds: Vec<Option<bool>> = (0..given.data.len())
        .map(|i| {
            let (g, r, w) = (&given.data[i], &right.data[i], &wrong.data[i]);
            let differs = (0..3).any(|c| (r[c] - w[c]).abs() > STREWN_LEAST);
            differs.then(|| distance(g, w) < distance(g, r))
        })
        .collect();
    let (width, mut pairs, mut mixed) = (given.width, 0usize, 0usize);
    for i in 0..kinds.len() {
        let across = (i % width + 1 < width).then_some(i + 1);
        for j in across.into_iter().chain([i + width]) {
            if let (Some(a), Some(Some(b))) = (kinds[i], kinds.get(j)) {
                pairs += 1;
                mixed += usize::from(a != *b);
            }
        }
    }
    let any = kinds.iter().filter(|kind| **kind == Some(true)).count();
    if any * 200 < kinds.len() || (mixed as f64) < STREWN * pairs as f64 {
        return None;
    }
    let pick = |i: usize| {
        if kinds[i] == Some(true) {
            wrong.data[i]
        } else {
            right.data[i]
        }
    };
    Some(Values {
        width,
        height: given.height,
        data: (0..given.data.len()).map(pick).collect(),
    })
}

/// Judges a picture by the right ones, in the order of modes, and the mistaken ones.
pub(super) fn judge(
    given: &Values,
    noise: Noise,
    rights: &[Right],
    candidates: &[Candidate],
) -> Judged {
    let nearest = |a: &&Right, b: &&Right| a.error.total_cmp(&b.error);
    let right = rights
        .iter()
        .min_by(nearest)
        .map_or(0, |r| index_of(rights, r.mode));
    let bench = Bench {
        given,
        noise,
        rights,
        candidates,
        right,
    };
    if noise.hides(&rights[right].picture, given) {
        match bench.beating() {
            Some(best) => bench.mistake(best),
            None => bench.right(),
        }
    } else {
        match bench.explaining() {
            Some(best) => bench.mistake(best),
            None => bench.unexplained(),
        }
    }
}

fn index_of(rights: &[Right], mode: Mode) -> usize {
    rights.iter().position(|r| r.mode == mode).unwrap_or(0)
}

/// What is judged; `right` is the nearest right picture.
struct Bench<'a> {
    given: &'a Values,
    noise: Noise,
    rights: &'a [Right],
    candidates: &'a [Candidate],
    right: usize,
}

impl Bench<'_> {
    fn nearest(&self) -> &Right {
        &self.rights[self.right]
    }

    /// The candidate of least error among some; the first of equals.
    fn least(&self, among: impl Fn(&Candidate) -> bool) -> Option<usize> {
        let found = self.candidates.iter().enumerate().filter(|(_, c)| among(c));
        found
            .min_by(|a, b| a.1.error.total_cmp(&b.1.error))
            .map(|(i, _)| i)
    }

    /// The mistake that is believed although the picture agrees with the right one within noise.
    fn beating(&self) -> Option<usize> {
        let right = self.nearest();
        self.least(|c| {
            let changed = mse(&c.picture, &right.picture);
            let gained = right.error.powi(2) - c.error.powi(2);
            changed > SAME * SAME
                && gained >= changed / 2.0
                && (c.error <= (1.0 - EXPLAINS) * right.error || self.shows(c))
        })
    }

    /// A mistake that removes little of the error is there all the same, and is no chance. What compression leaves is no
    /// chance either: it follows the picture, as mistakes do, so in a lossy file a mistake must stand out from it.
    fn shows(&self, c: &Candidate) -> bool {
        let right = &self.nearest().picture;
        surely_nearer(self.given, &c.picture, right) >= SURE
            && (!self.noise.follows || stands_out(self.given, &c.picture, right))
    }

    /// The mistake that explains most of a picture that does not agree with the right one.
    fn explaining(&self) -> Option<usize> {
        self.least(|c| self.explains(c))
    }

    fn explains(&self, c: &Candidate) -> bool {
        let right = &self.rights[index_of(self.rights, c.mode)];
        let much = c.error <= (1.0 - EXPLAINS) * self.nearest().error;
        let enough = c.error <= STAYS * contrast(&right.picture);
        much && (enough || self.agrees(c))
    }

    /// Two mistakes cannot be told apart: their pictures are the same, or noise hides which one it is.
    fn tied(&self, best: &Candidate, other: &Candidate) -> bool {
        let apart = mse(&best.picture, &other.picture);
        let behind = other.error.powi(2) - best.error.powi(2);
        apart <= SAME * SAME || (best.error > SAME && self.agrees(best) && behind < apart / 2.0)
    }

    fn agrees(&self, c: &Candidate) -> bool {
        self.noise.hides(&c.picture, self.given)
    }

    fn finding(&self, c: &Candidate, tied: bool) -> Finding {
        let right = &self.rights[index_of(self.rights, c.mode)];
        let mistake = &all()[c.mistake];
        let removed = if right.error > 0.0 {
            1.0 - c.error / right.error
        } else {
            0.0
        };
        Finding {
            mistake,
            mode: c.mode,
            amount: mistake.has_amount().then_some(c.amount),
            error: c.error,
            removed,
            tied,
        }
    }

    /// Findings in the order of their errors, each mistake once.
    fn findings(&self, first: Option<usize>, among: impl Fn(&Candidate) -> bool) -> Vec<Finding> {
        let best = first.map(|i| &self.candidates[i]);
        let mut order: Vec<&Candidate> = self.candidates.iter().filter(|c| among(c)).collect();
        order.sort_by(|a, b| a.error.total_cmp(&b.error));
        let mut told: Vec<usize> = Vec::new();
        let mut tied = Vec::new();
        let mut rest = Vec::new();
        for c in best.into_iter().chain(order) {
            if told.contains(&c.mistake) {
                continue;
            }
            told.push(c.mistake);
            match best {
                Some(b) if c.mistake != b.mistake && self.tied(b, c) => {
                    tied.push(self.finding(c, true))
                }
                Some(b) if c.mistake == b.mistake => tied.insert(0, self.finding(c, false)),
                _ => rest.push(self.finding(c, false)),
            }
        }
        let room = TOLD.saturating_sub(tied.len()).min(HELPING);
        tied.into_iter()
            .chain(rest.into_iter().take(room))
            .collect()
    }

    fn right(&self) -> Judged {
        let right = self.nearest();
        let same = |picture: &Values| mse(picture, &right.picture) <= SAME * SAME;
        let others = self.rights.iter().filter(|r| r.mode != right.mode);
        let also: Vec<Mode> = others
            .filter(|r| same(&r.picture))
            .map(|r| r.mode)
            .collect();
        // What would be a mistake, had the picture been meant for something else.
        let meant =
            |c: &Candidate| c.mode != right.mode && !also.contains(&c.mode) && same(&c.picture);
        Judged {
            verdict: Verdict::Right,
            mode: right.mode,
            right: self.right,
            best: None,
            findings: self.findings(None, meant),
            also,
        }
    }

    fn mistake(&self, best: usize) -> Judged {
        let mode = self.candidates[best].mode;
        let first = &self.candidates[best];
        Judged {
            verdict: Verdict::Mistake,
            mode,
            also: Vec::new(),
            right: index_of(self.rights, mode),
            best: Some(best),
            findings: self.findings(Some(best), |c| self.explains(c) || self.tied(first, c)),
        }
    }

    fn unexplained(&self) -> Judged {
        let least = self.nearest().error;
        let helps = |c: &Candidate| c.mode == self.nearest().mode && c.error < 0.75 * least;
        let mut findings = self.findings(None, helps);
        findings.truncate(2);
        Judged {
            verdict: Verdict::Unexplained,
            mode: self.nearest().mode,
            also: Vec::new(),
            right: self.right,
            best: None,
            findings,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(value: impl Fn(usize, usize) -> f32) -> Values {
        let (width, height) = (64, 48);
        let data = (0..width * height).map(|i| [value(i % width, i / width); 3]);
        Values {
            width,
            height,
            data: data.collect(),
        }
    }

    fn noise(i: usize) -> f32 {
        ((i * 7919) % 17) as f32 / 17.0 - 0.47
    }

    fn candidate(mistake: usize, picture: Values, given: &Values) -> Candidate {
        Candidate {
            mistake,
            mode: Mode::Trace,
            amount: 1.0,
            error: rmse(&picture, given),
            picture,
        }
    }

    #[test]
    fn a_small_mistake_is_believed_under_larger_noise_and_noise_is_not() {
        let right = plane(|x, y| (x + y) as f32 / 120.0);
        // rmse 0.0035, under noise of 0.012.
        let wrong = plane(|x, y| (x + y) as f32 / 120.0 + if x < 48 { 0.004 } else { 0.0 });
        let noisy = |of: &Values| {
            let mut picture = of.clone();
            for (i, c) in picture.data.iter_mut().enumerate() {
                *c = c.map(|x| x + 0.04 * noise(i));
            }
            picture
        };
        for (given, verdict) in [
            (noisy(&right), Verdict::Right),
            (noisy(&wrong), Verdict::Mistake),
        ] {
            let rights = [Right::new(Mode::Trace, right.clone(), &given)];
            assert!(rights[0].error > 0.008 && Noise::LOSSLESS.hides(&rights[0].picture, &given));
            let candidates = [candidate(0, wrong.clone(), &given)];
            assert_eq!(
                judge(&given, Noise::LOSSLESS, &rights, &candidates).verdict,
                verdict
            );
        }
    }

    #[test]
    fn in_a_lossy_file_a_mistake_must_stand_out_from_the_noise() {
        let right = plane(|x, y| (x + y) as f32 / 120.0);
        // Up and down from pixel to pixel, so that means hide it.
        let rough = |by: f32| {
            plane(|x, y| {
                let sign = if (x + y) % 2 == 0 { by } else { -by };
                (x + y) as f32 / 120.0 + if x < 48 { sign } else { 0.0 }
            })
        };
        for (by, verdict) in [(0.04, Verdict::Mistake), (0.008, Verdict::Right)] {
            let lossy = Noise::LOSSY;
            let wrong = rough(by);
            let mut given = wrong.clone();
            for (i, c) in given.data.iter_mut().enumerate() {
                *c = c.map(|x| x + 0.1 * noise(i));
            }
            let rights = [Right::new(Mode::Trace, right.clone(), &given)];
            let candidates = [candidate(0, wrong, &given)];
            assert!(lossy.hides(&right, &given) && candidates[0].error > 0.5 * rights[0].error);
            assert_eq!(judge(&given, lossy, &rights, &candidates).verdict, verdict);
        }
    }

    #[test]
    fn equal_pictures_tie_and_others_do_not() {
        let right = plane(|x, _| x as f32 / 64.0);
        let given = plane(|x, _| x as f32 / 128.0);
        let rights = [Right::new(Mode::Trace, right.clone(), &given)];
        let candidates = [
            candidate(0, given.clone(), &given),
            candidate(1, plane(|x, _| x as f32 / 120.0), &given),
            candidate(2, given.map(|c| c.map(|x| x + 1e-4)), &given),
        ];
        let judged = judge(&given, Noise::LOSSLESS, &rights, &candidates);
        assert_eq!(judged.verdict, Verdict::Mistake);
        let found: Vec<(&str, bool)> = judged
            .findings
            .iter()
            .map(|f| (f.mistake.name, f.tied))
            .collect();
        let name = |i: usize| all()[i].name;
        assert_eq!(found, [(name(0), false), (name(2), true), (name(1), false)]);
        assert!((judged.findings[0].removed - 1.0).abs() < 1e-12);
    }

    #[test]
    fn an_unrelated_picture_is_not_explained_by_what_happens_to_help() {
        let right = plane(|x, _| x as f32 / 80.0);
        let given = plane(|x, y| if (x / 4 + y / 4) % 2 == 0 { 0.9 } else { 0.1 });
        let rights = [Right::new(Mode::Cast, right.clone(), &given)];
        let helps = right.map(|c| c.map(|x| 0.5 * x + 0.25));
        let candidates = [candidate(0, helps, &given)];
        assert_eq!(
            judge(&given, Noise::LOSSLESS, &rights, &candidates).verdict,
            Verdict::Unexplained
        );
    }

    #[test]
    fn strewn_pixels_are_told_from_regions() {
        let (light, dark) = (plane(|_, _| 0.8), plane(|_, _| 0.2));
        let acne = plane(|x, y| if (x * 5 + y * 3) % 7 < 3 { 0.2 } else { 0.8 });
        let shadow = plane(|x, y| if x < 32 && y < 24 { 0.2 } else { 0.8 });
        assert_eq!(strewn(&acne, &light, &dark), Some(acne.clone()));
        assert_eq!(strewn(&shadow, &light, &dark), None);
        assert_eq!(strewn(&light, &light, &dark), None);
    }
}
