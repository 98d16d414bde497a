//! Loops over elements whose results do not depend on the number of threads.

/// Elements a task takes at a time. Sums are formed chunk by chunk, so this number is part of the result's bits.
const CHUNK: usize = 256;

/// Evaluates `f` for `0..count`, in parallel where the feature `parallel` is on, and returns the results in order.
pub fn parallel_map<T: Send>(count: usize, f: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        (0..count)
            .into_par_iter()
            .with_min_len(CHUNK.min(32))
            .map(f)
            .collect()
    }
    #[cfg(not(feature = "parallel"))]
    {
        (0..count).map(f).collect()
    }
}

/// Σ f(i) for `i` in `0..count`: partial sums of fixed chunks, added in order.
pub fn ordered_sum(count: usize, f: impl Fn(usize) -> f64 + Sync + Send) -> f64 {
    let chunk_sum = |chunk: usize| {
        (chunk * CHUNK..((chunk + 1) * CHUNK).min(count))
            .map(&f)
            .sum::<f64>()
    };
    let num_chunks = count.div_ceil(CHUNK);
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        let sums: Vec<f64> = (0..num_chunks).into_par_iter().map(chunk_sum).collect();
        sums.iter().sum()
    }
    #[cfg(not(feature = "parallel"))]
    {
        (0..num_chunks).map(chunk_sum).sum()
    }
}
