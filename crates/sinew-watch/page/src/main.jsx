// Frame of the page, and selection of the content by address.
import { Fragment, h, render } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import { Alarms } from "./alarms.jsx";
import { Compare } from "./compare.jsx";
import { Due } from "./due.jsx";
import { Fleet } from "./fleet.jsx";
import { time } from "./format.js";
import { Journal } from "./journal.jsx";
import { logout, mayOperate } from "./api.js";
import { follow, loggedOut, useLive } from "./live.js";
import { Login } from "./login.jsx";
import { Plan } from "./plan.jsx";
import { Robot } from "./robot.jsx";
import { Tendon } from "./tendon.jsx";

const place = () => location.pathname.split("/").filter(Boolean).map(decodeURIComponent);

// Focuses the heading of a new page for screen readers, once its data are loaded. The heading of the previous page may still
// be present, or be replaced when data arrive: then the new one is focused.
function focusHeading() {
  const begun = performance.now();
  let focused;
  const look = () => {
    const since = performance.now() - begun;
    const heading = document.querySelector("h1");
    const lost = !focused?.isConnected && (!focused || document.activeElement === document.body);
    if (heading && lost) {
      heading.focus();
      focused = heading;
    }
    if (since < (focused ? 2_000 : 10_000)) setTimeout(look, 30);
  };
  setTimeout(look, 30);
}

// Internal links change the address without reloading the page.
function usePlace() {
  const [now, set] = useState(place);
  useEffect(() => {
    const go = () => set(place());
    const click = event => {
      const link = event.target.closest?.("a[href^='/']");
      const plain = event.button === 0 && !event.ctrlKey && !event.metaKey && !event.shiftKey && !event.altKey;
      if (!link || !plain || link.hasAttribute("download") || link.target) return;
      event.preventDefault();
      if (link.pathname !== location.pathname) {
        history.pushState(null, "", link.pathname + link.search);
        scrollTo(0, 0);
      }
      go();
      focusHeading();
    };
    addEventListener("popstate", go);
    document.addEventListener("click", click);
    return () => { removeEventListener("popstate", go); document.removeEventListener("click", click); };
  }, []);
  return now;
}

function Nav({ here, live }) {
  const alarms = [...live.robots.values()].reduce((sum, row) => sum + row.unacknowledged, 0);
  const link = (href, name, of) => (
    <a href={href} aria-current={of.includes(here ?? "") ? "page" : undefined}>{name}</a>
  );
  return (
    <nav aria-label="pages">
      <a class="brand" href="/">Sinew watch</a>
      {link("/", "Robots", ["", "r"])}
      {link("/due", "Maintenance", ["due", "plan"])}
      {link("/compare", "Compare", ["compare"])}
      {link("/alarms", <>Alarms{alarms > 0 && <b class="count" title="unacknowledged">{alarms}</b>}</>, ["alarms"])}
      {link("/journal", "Journal", ["journal"])}
      <Pulse live={live} />
      <LogOut />
    </nav>
  );
}

// Shown where the monitor requires a login.
function LogOut() {
  const [error, setError] = useState("");
  if (!document.cookie.includes("sinew_watch_open=")) return null;
  const end = async () => {
    try { await logout(); loggedOut(); }
    catch (failure) { setError(failure.message); }
  };
  return <>{!mayOperate() && <span>Read only</span>}<button onClick={end}>Log out</button>{error && <span class="error" role="alert">{error}</span>}</>;
}

// Title of the tab: number of active alarms, then the page.
function useTitle(live, page, rest) {
  const active = [...live.robots.values()].reduce((sum, row) => sum + row.active, 0);
  const names = { due: "Maintenance", plan: "Month plan", compare: "Compare tendons", alarms: "Alarms", journal: "Journal", r: rest.slice().reverse().join(" of ") };
  const name = page === undefined ? "Robots" : names[page] ?? "Page not found";
  const title = `${live.lost ? "(disconnected) " : active > 0 ? `(${active}) ` : ""}${name} – Sinew watch`;
  useEffect(() => { document.title = title; }, [title]);
}

// Connection state and time of the monitor.
function Pulse({ live }) {
  if (live.lost) return <span class="pulse lost">Disconnected</span>;
  return <span class="pulse" title="time of the monitor">{live.fleet ? time(live.fleet.time_utc_s) : "…"}</span>;
}

function Banners({ live }) {
  const store = live.fleet?.store;
  return (
    <>
      {live.fleet?.demo && (
        <p class="banner demo"><strong>Demo:</strong> {live.fleet.demo}</p>
      )}
      <div role="status">
        {live.lost && (
          <p class="banner alarm">
            <strong>Disconnected since {time(live.received_ms / 1000)}.</strong> Values below are from that time. Check that{" "}
            <code>sinew watch</code> is running.
          </p>
        )}
        {store?.kind === "failing" && !live.lost && (
          <p class="banner alarm">
            <strong>Storage failure: {store.reason}.</strong> {store.waiting} changes are in memory only and are lost if
            the monitor stops. The estimate continues.
          </p>
        )}
      </div>
    </>
  );
}

function App() {
  const live = useLive();
  const [page, ...rest] = usePlace();
  const robot = page === "r" ? rest[0] : null;
  useEffect(() => follow(robot), [robot]);
  useTitle(live, page, rest);
  if (live.login) return <main><Login /></main>;
  let content;
  if (page === undefined) content = <Fleet live={live} />;
  else if (page === "r" && rest.length === 1) content = <Robot key={robot} name={robot} live={live} />;
  else if (page === "r" && rest.length === 2) content = <Tendon key={rest.join("/")} robot={robot} joint={rest[1]} live={live} />;
  else if (page === "due") content = <Due live={live} />;
  else if (page === "plan") content = <Plan live={live} />;
  else if (page === "compare") content = <Compare live={live} />;
  else if (page === "alarms") content = <Alarms live={live} />;
  else if (page === "journal") content = <Journal live={live} robot={rest[0]} />;
  else content = <h1 tabindex="-1">Page not found</h1>;
  return (
    <>
      <a class="skip" href="#content">Skip to content</a>
      <Nav here={page} live={live} />
      <main id="content" class={live.lost ? "old" : ""}>
        <Banners live={live} />
        {content}
        <footer>
          {live.fleet && <>Sinew {live.fleet.version}. Read-only: it never commands a robot. </>}
          <a href="/api/v1/openapi.json" target="_blank">API</a> · <a href="/metrics" target="_blank">Metrics</a> ·{" "}
          Export records: <a href="/api/v1/records.csv" download>CSV</a>, <a href="/api/v1/records.parquet" download>Parquet</a>
        </footer>
      </main>
    </>
  );
}

render(<App />, document.getElementById("app"));
