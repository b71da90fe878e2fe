import { h } from "preact";
import { useState } from "preact/hooks";
import { login } from "./api.js";
import { loggedIn } from "./live.js";

export function Login() {
  const [token, setToken] = useState("");
  const [error, setError] = useState("");
  const submit = async event => {
    event.preventDefault();
    try { await login(token.trim()); setError(""); loggedIn(); }
    catch (failure) { setError(failure.message); }
  };
  return (
    <form class="login" onSubmit={submit}>
      <h1 tabindex="-1">Sinew watch</h1>
      <p>Token: see file <code>web-token</code> in the store directory of the monitor host.</p>
      <label>Token <input type="password" autocomplete="current-password" value={token} required
        onInput={event => setToken(event.target.value)} /></label>
      <button class="main">Log in</button>
      {error && <p class="error" role="alert">{error}</p>}
    </form>
  );
}
