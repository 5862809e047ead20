//! Which rays of a tree are shown: those that matter most to the pixel, each with all its ancestors.

use crate::explain::Ray;

/// A tree of which some rays are shown.
pub(super) struct Picked {
    /// For each ray: it is shown.
    pub(super) shown: Vec<bool>,
    /// For each ray: those whose parent it is, reflection before refraction.
    pub(super) children: Vec<Vec<usize>>,
}

/// The `most` rays with the largest part in the pixel, of those that add at least `least`, and the first. A ray counts as much
/// as the most important one that follows from it.
pub(super) fn pick(rays: &[Ray], most: usize, least: f64) -> Picked {
    let mut children = vec![Vec::new(); rays.len()];
    let mut weight: Vec<f64> = rays.iter().map(own).collect();
    for (id, ray) in rays.iter().enumerate().rev() {
        if let Some(parent) = ray.parent {
            children[parent].insert(0, id);
            weight[parent] = weight[parent].max(weight[id]);
        }
    }
    let mut order: Vec<usize> = (0..rays.len()).collect();
    // Parents come before their children among equals: numbers grow with the generation.
    order.sort_by(|a, b| weight[*b].total_cmp(&weight[*a]).then(a.cmp(b)));
    let mut shown = vec![false; rays.len()];
    for id in order.into_iter().take(most) {
        shown[id] = id == 0 || weight[id] >= least;
    }
    Picked { shown, children }
}

/// What a ray adds by its own hit: the largest channel.
fn own(ray: &Ray) -> f64 {
    added(ray).into_iter().fold(0.0, |m: f64, x| m.max(x.abs()))
}

/// What a ray adds to the pixel by the local terms of its own hit: path weight times term.
pub(super) fn added(ray: &Ray) -> [f64; 3] {
    let mut sum = [ray.terms.emission, ray.terms.ambient]
        .iter()
        .fold([0.0; 3], |s, t| plus(s, *t));
    for light in &ray.terms.lights {
        for term in [light.ambient, light.diffuse, light.specular] {
            sum = plus(sum, term);
        }
    }
    [0, 1, 2].map(|c| match ray.weight[c] * sum[c] {
        x if x.is_nan() => 0.0,
        x => x,
    })
}

pub(super) fn plus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

impl Picked {
    /// How many rays a subtree has, and what they add together.
    pub(super) fn subtree(&self, rays: &[Ray], root: usize) -> (usize, [f64; 3]) {
        let (mut count, mut sum) = (0, [0.0; 3]);
        let mut waiting = vec![root];
        while let Some(id) = waiting.pop() {
            count += 1;
            sum = plus(sum, added(&rays[id]));
            waiting.extend(&self.children[id]);
        }
        (count, sum)
    }
}
