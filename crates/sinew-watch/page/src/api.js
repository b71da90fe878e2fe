// Requests to the monitor.

export class RequestError extends Error {
  constructor(status, message) { super(message); this.status = status; }
}

async function answer(response) {
  const body = await response.json().catch(() => null);
  if (response.ok) return body;
  throw new RequestError(response.status, body?.error ?? `HTTP status ${response.status}`);
}

const path = parts => "/api/v1/" + parts.map(encodeURIComponent).join("/");

export const get = async (parts, query = {}) => {
  const given = Object.entries(query).filter(([, value]) => value !== null && value !== undefined && value !== "");
  const text = new URLSearchParams(given).toString();
  return answer(await fetch(path(parts) + (text && `?${text}`), { cache: "no-store" }));
};

// A custom header, which a form of another site cannot send.
const post = async (url, body) => answer(await fetch(url, {
  method: "POST",
  headers: { "content-type": "application/json", "x-sinew": "1" },
  body: JSON.stringify(body),
}));

export const command = (robot, who, note, what) => post(path(["robots", robot, "commands"]), { who, note, what });
export const login = token => post("/login", { token });
export const logout = () => post("/logout", {});
