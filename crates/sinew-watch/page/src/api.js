// Requests to the monitor.

export class RequestError extends Error {
  constructor(status, message) { super(message); this.status = status; }
}

// Time after which a request without a response has failed, ms.
const MAX_WAIT_MS = 20_000;

let loginRequired = () => {};
// Called when a request is rejected because nobody is logged in.
export function onLoginRequired(call) { loginRequired = call; }

async function answer(response) {
  const body = await response.json().catch(() => null);
  if (response.ok) return body;
  if (response.status === 401 && !response.url.endsWith("/login")) loginRequired();
  throw new RequestError(response.status, body?.error ?? `HTTP status ${response.status}`);
}

const path = parts => "/api/v1/" + parts.map(encodeURIComponent).join("/");

export const get = async (parts, query = {}) => {
  const given = Object.entries(query).filter(([, value]) => value !== null && value !== undefined && value !== "");
  const text = new URLSearchParams(given).toString();
  const asked = fetch(path(parts) + (text && `?${text}`), { cache: "no-store", signal: AbortSignal.timeout(MAX_WAIT_MS) });
  const response = await asked.catch(error => {
    throw new RequestError(0, error.name === "TimeoutError" ? "No response within 20 s" : "Monitor not reachable");
  });
  return answer(response);
};

// A custom header, which a form of another site cannot send.
const post = async (url, body) => answer(await fetch(url, {
  method: "POST",
  headers: { "content-type": "application/json", "x-sinew": "1" },
  body: JSON.stringify(body),
}));

// Whether the login permits commands; without a login everything is permitted.
export const mayOperate = () => !document.cookie.includes("sinew_watch_open=read");

export const command = (robot, who, note, what) => post(path(["robots", robot, "commands"]), { who, note, what });
export const testNotifications = () => post(path(["notify", "test"]), {});
export const login = token => post("/login", { token });
export const logout = () => post("/logout", {});
