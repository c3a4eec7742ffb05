//! Which interval of each segment: the chain whose narrowest interval is widest.

use crate::intervals::Interval;

/// One interval a segment, each overlapping the one before, so that the narrowest is as wide as can
/// be; of equals the one that turns the tool least. Angles run on without whole turns between them.
///
/// # Errors
/// The first segment that no chain reaches.
pub(crate) fn widest(segments: &[&[Interval]]) -> Result<Vec<Interval>, usize> {
    let mut reached: Vec<Vec<Option<ChainLink>>> = Vec::with_capacity(segments.len());
    for (k, intervals) in segments.iter().enumerate() {
        let links: Vec<Option<ChainLink>> = intervals
            .iter()
            .map(|interval| match k {
                0 => Some(ChainLink::first(interval)),
                _ => best(&reached[k - 1], segments[k - 1], interval),
            })
            .collect();
        if links.iter().all(Option::is_none) {
            return Err(k);
        }
        reached.push(links);
    }
    Ok(back(segments, &reached))
}

/// How an interval is reached.
#[derive(Debug, Clone, Copy)]
struct ChainLink {
    narrowest_rad: f64,
    turned_rad: f64,
    /// Interval of the segment before.
    from: usize,
}

impl ChainLink {
    fn first(interval: &Interval) -> Self {
        Self {
            narrowest_rad: interval.width_rad(),
            turned_rad: 0.0,
            from: 0,
        }
    }

    fn is_better(&self, other: &Self) -> bool {
        let widths = self.narrowest_rad.total_cmp(&other.narrowest_rad);
        widths
            .then(other.turned_rad.total_cmp(&self.turned_rad))
            .is_gt()
    }
}

fn best(before: &[Option<ChainLink>], intervals: &[Interval], to: &Interval) -> Option<ChainLink> {
    let mut found: Option<ChainLink> = None;
    for (from, (link, interval)) in before.iter().zip(intervals).enumerate() {
        let Some(link) = link.filter(|_| interval.overlaps(to)) else {
            continue;
        };
        let middle = interval.middle_rad();
        let turn = (to.turned_to(middle).middle_rad() - middle).abs();
        let longer = ChainLink {
            narrowest_rad: link.narrowest_rad.min(to.width_rad()),
            turned_rad: link.turned_rad + turn,
            from,
        };
        if found.is_none_or(|best| longer.is_better(&best)) {
            found = Some(longer);
        }
    }
    found
}

fn back(segments: &[&[Interval]], reached: &[Vec<Option<ChainLink>>]) -> Vec<Interval> {
    let mut chain: Vec<Interval> = Vec::with_capacity(segments.len());
    let Some(last) = reached.last() else {
        return chain;
    };
    let links = last.iter().enumerate();
    let mut best: Option<(usize, ChainLink)> = None;
    for (i, link) in links.filter_map(|(i, link)| link.map(|link| (i, link))) {
        if best.is_none_or(|(_, other)| link.is_better(&other)) {
            best = Some((i, link));
        }
    }
    let mut at = best.map_or(0, |(i, _)| i);
    for k in (0..segments.len()).rev() {
        chain.push(segments[k][at]);
        at = reached[k][at].map_or(0, |link| link.from);
    }
    chain.reverse();
    for k in 1..chain.len() {
        chain[k] = chain[k].turned_to(chain[k - 1].middle_rad());
    }
    chain
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn interval(sheet: usize, from_deg: f64, to_deg: f64) -> Interval {
        Interval {
            sheet,
            from_rad: from_deg.to_radians(),
            to_rad: to_deg.to_radians(),
        }
    }

    fn chain_of(segments: &[Vec<Interval>]) -> Result<Vec<Interval>, usize> {
        let segments: Vec<&[Interval]> = segments.iter().map(Vec::as_slice).collect();
        widest(&segments)
    }

    /// The interval that is wide at first ends in one that is narrow; the other way is taken.
    #[test]
    fn the_narrowest_interval_decides() {
        let segments = [
            vec![interval(0, 0.0, 80.0), interval(0, 100.0, 140.0)],
            vec![interval(0, 60.0, 65.0), interval(0, 110.0, 140.0)],
        ];
        let chain = chain_of(&segments).expect("a chain");
        assert_eq!(chain, [segments[0][1], segments[1][1]]);
    }

    #[test]
    fn sheets_are_not_mixed_and_turns_are_counted_on() {
        let apart = [vec![interval(0, 0.0, 40.0)], vec![interval(1, 0.0, 40.0)]];
        assert_eq!(chain_of(&apart), Err(1));
        let across = [
            vec![interval(0, 340.0, 370.0)],
            vec![interval(0, 0.0, 20.0)],
        ];
        let chain = chain_of(&across).expect("a chain");
        assert!((chain[1].middle_rad().to_degrees() - 370.0).abs() < 1e-9);
    }

    fn any_intervals() -> impl Strategy<Value = Vec<Interval>> {
        let one = (0..2_usize, 0.0..360.0_f64, 5.0..80.0_f64);
        let one = one.prop_map(|(sheet, from, wide)| interval(sheet, from, from + wide));
        prop::collection::vec(one, 1..4)
    }

    /// The narrowest interval of the best chain, all chains tried.
    fn tried(segments: &[Vec<Interval>], from: Option<Interval>) -> Option<f64> {
        let Some((first, rest)) = segments.split_first() else {
            return Some(f64::INFINITY);
        };
        let open = first.iter().filter(|i| from.is_none_or(|f| f.overlaps(i)));
        let all = open.filter_map(|i| Some(i.width_rad().min(tried(rest, Some(*i))?)));
        all.max_by(f64::total_cmp)
    }

    proptest! {
        #[test]
        fn the_chain_is_the_widest_of_all(segments in prop::collection::vec(any_intervals(), 1..6)) {
            let expected = tried(&segments, None);
            match chain_of(&segments) {
                Ok(chain) => {
                    let widths_rad = chain.iter().map(Interval::width_rad);
                    let narrowest = widths_rad.fold(f64::INFINITY, f64::min);
                    prop_assert!((narrowest - expected.expect("a chain")).abs() < 1e-9);
                    prop_assert!(chain.windows(2).all(|w| w[0].overlaps(&w[1])));
                }
                Err(_) => prop_assert_eq!(expected, None),
            }
        }
    }
}
