//! Reports as CSV for a spreadsheet.

use crate::report::Report;

/// Formats a report as CSV (RFC 4180, lines end with LF), one row for each strategy, measure, kind of numbers and number of samples. Errors
/// are relative. The `bias_*` columns are of the channel whose bias is largest in standard errors. A field without a value is empty.
#[must_use]
pub fn csv(report: &Report) -> String {
    let mut text = String::from(
        "measure,numbers,strategy,samples,seeds,relative_rms_error,error_low,error_high,slope,slope_low,slope_high,\
         ns_a_sample,seconds,bias_channel,bias_relative,bias_standard_errors,ciede2000\n",
    );
    for series in &report.series {
        let slope = series.slope.map_or(",,".to_owned(), |s| format!("{},{},{}", s.value, s.low, s.high));
        for point in &series.points {
            let worst = point.bias.iter().max_by(|a, b| a.standard_errors.abs().total_cmp(&b.standard_errors.abs()));
            let bias = worst
                .map_or(",,".to_owned(), |b| format!("{},{},{}", quoted(&b.channel), b.relative, b.standard_errors));
            let color = point.ciede2000.map_or(String::new(), |d| d.to_string());
            text.push_str(&format!(
                "{},{},{},{},{},{},{},{},{slope},{},{},{bias},{color}\n",
                series.measure.name(),
                series.numbers.name(),
                quoted(&series.strategy),
                point.samples,
                series.seeds,
                point.error.value,
                point.error.low,
                point.error.high,
                series.ns_a_sample,
                point.seconds,
            ));
        }
    }
    text
}

/// Formats the results of each seed as CSV: one row for each strategy, measure, kind of sample numbers (Sobol, random, ...),
/// number of samples and seed. A row has the relative RMS error and, for each channel, the signed relative error of its light.
/// This second error is empty for channels that record none.
#[must_use]
pub fn seeds_csv(report: &Report) -> String {
    let channels: Vec<String> = report.channels.iter().map(|name| quoted(&format!("relative_error {name}"))).collect();
    let mut text = format!("measure,numbers,strategy,samples,seed,relative_rms_error,{}\n", channels.join(","));
    for series in &report.series {
        let of_series = format!("{},{},{}", series.measure.name(), series.numbers.name(), quoted(&series.strategy));
        for point in &series.points {
            for of_seed in &point.by_seed {
                let of_channel = |name: &String| {
                    let at = point.bias.iter().position(|bias| bias.channel == *name);
                    at.map_or(String::new(), |at| of_seed.relative[at].to_string())
                };
                let errors: Vec<String> = report.channels.iter().map(of_channel).collect();
                let (samples, seed, error) = (point.samples, of_seed.seed, of_seed.error);
                text.push_str(&format!("{of_series},{samples},{seed},{error},{}\n", errors.join(",")));
            }
        }
    }
    text
}

fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}
