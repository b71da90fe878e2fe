// Tendons that are due, by the week of the median: as the report of a fleet counts them (fleet/src/report/weeks.rs).

export const WEEK_S = 7 * 86400;

function groupOf(tendon, until_utc_s) {
  if (tendon.state === "passed") return "passed";
  if (tendon.at_utc_s === null || tendon.at_utc_s > until_utc_s) return "perhaps";
  // A median between the last session and now counts as this week.
  return Math.max(0, Math.floor(tendon.after_s / WEEK_S));
}

// Groups of tendons by due date: [group, tendons]. A group is "passed", a number of weeks from now, or "perhaps" if only the
// lower end of the interval is within the time range.
export function byWeek(list) {
  const groups = new Map();
  for (const tendon of list.due) {
    const what = groupOf(tendon, list.until_utc_s);
    if (!groups.has(what)) groups.set(what, []);
    groups.get(what).push(tendon);
  }
  return [...groups];
}

export function weekName(weeks) {
  if (weeks === 0) return "This week";
  return weeks === 1 ? "Next week" : `In ${weeks} weeks`;
}
