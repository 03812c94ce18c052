//! Today.

use std::time::{SystemTime, UNIX_EPOCH};

/// The date in UTC, as `2026-11-25`.
pub(super) fn today() -> String {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs());
    let [year, month, day] = civil(seconds / 86_400);
    format!("{year:04}-{month:02}-{day:02}")
}

/// Year, month and day of a day after 1970-01-01 in the Gregorian calendar. Years begin with March, so that
/// the leap day is the last of its year (Richards, in the Explanatory Supplement to the Astronomical Almanac).
fn civil(days: u64) -> [u64; 3] {
    let days = days + 719_468;
    let (era, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let (year, month, day) = (year + era * 400, month, day - (153 * month + 2) / 5 + 1);
    if month < 10 { [year, month + 3, day] } else { [year + 1, month - 9, day] }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Known dates, with leap days and turns of the year.
    #[test]
    fn days_have_dates() {
        for (days, date) in [
            (0, [1970, 1, 1]),
            (58, [1970, 2, 28]),
            (59, [1970, 3, 1]),
            (11_016, [2000, 2, 29]),
            (11_017, [2000, 3, 1]),
            (20_782, [2026, 11, 25]),
            (20_819, [2027, 1, 1]),
        ] {
            assert_eq!(civil(days), date);
        }
    }
}
