import { useState } from "preact/hooks";
import { login } from "./api.js";
import { loggedIn } from "./live.js";

export function Login() {
  const [token, setToken] = useState("");
  const [error, setError] = useState("");
  const submit = async event => {
    event.preventDefault();
    try { await login(token.trim()); setError(""); loggedIn(); }
    catch (refused) { setError(refused.message); }
  };
  return (
    <form class="login" onSubmit={submit}>
      <h1 tabindex="-1">Sinew watch</h1>
      <p>The token stands in the file <code>web-token</code> in the monitor's store, on its computer.</p>
      <label>Token <input type="password" autocomplete="current-password" value={token} required
        onInput={event => setToken(event.target.value)} /></label>
      <button class="main">Show</button>
      {error && <p class="refused" role="alert">{error}</p>}
    </form>
  );
}
